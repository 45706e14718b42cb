//! Methods that choose the next view in a closed loop.

use super::prediction_source::PredictionSource;
use next_best_view::ViewSelection;
use view_planning::PlanSettings;

/// Deviation of the paper's weight by distance, which it does not give, in diameters of the
/// candidates. Chosen.
const PAPER_SIGMA_SHARE: f64 = 0.35;
/// Deviation of the weight at which distance does not count, in diameters of the candidates.
const NO_DISTANCE: f64 = 1000.0;
/// Weight of the information gain at which entropy does not count.
const ONLY_GAIN: f64 = 1000.0;

coded_enum::coded_enum! {
    /// Method that chooses the next view.
    pub(super) enum Method {
        /// Greatest weighted entropy with information gain and a penalty near visited views: ours.
        Greedy, "greedy";
        /// The same with the true poses of all objects, with noise: a bound.
        GreedyTruth, "greedy-truth";
        /// Greatest weighted entropy, equation 3 alone.
        Entropy, "entropy";
        /// Draw by weighted entropy, equation 4.
        Sampled, "sampled";
        /// Greatest information gain of the unknown voxels.
        InformationGain, "information-gain";
        /// Any view that was not visited.
        Random, "random";
        /// Farthest from all visited views.
        Farthest, "farthest";
        /// Nearest to the current view.
        Nearest, "nearest";
        /// Least weighted entropy, as the paper's text says in places.
        Least, "least";
    }
}

impl Method {
    /// Source of the hypotheses that the method plans with.
    pub(super) fn source(self) -> PredictionSource {
        match self {
            Self::GreedyTruth => PredictionSource::NoisyTruth,
            _ => PredictionSource::Registered,
        }
    }

    /// Settings of the plan: ours, or those of the paper, which has no information gain and
    /// excludes no more than the visited views themselves.
    pub(super) fn settings(self, ours: &PlanSettings) -> PlanSettings {
        let paper = PlanSettings {
            sigma_share: PAPER_SIGMA_SHARE,
            visited_share: 0.0,
            gain_weight: 0.0,
            ..*ours
        };
        match self {
            Self::Greedy | Self::GreedyTruth => *ours,
            Self::Sampled => PlanSettings {
                selection: ViewSelection::Sampled { beta: 1.0 },
                ..paper
            },
            Self::Least => PlanSettings {
                selection: ViewSelection::Least,
                ..paper
            },
            // Neither distance nor entropy counts beside so much gain.
            Self::InformationGain => PlanSettings {
                sigma_share: NO_DISTANCE,
                gain_weight: ONLY_GAIN,
                ..paper
            },
            _ => paper,
        }
    }
}
