//! Methods that choose the next view in a closed loop.

use next_best_view::Config;

/// Deviation of the paper's weight by distance, which it does not give, in diameters of the
/// candidates. Chosen.
const PAPER_SIGMA_SHARE: f64 = 0.35;

coded_enum::coded_enum! {
    /// Method that chooses the next view.
    pub(super) enum Method {
        /// Greatest weighted entropy with information gain and a penalty near visited views: ours.
        Greedy, "greedy";
        /// The same with the true poses of the objects that were found, with noise.
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
    /// `true` if the method renders virtual views.
    pub(super) fn needs_entropy(self) -> bool {
        matches!(
            self,
            Self::Greedy | Self::GreedyTruth | Self::Entropy | Self::Sampled | Self::Least
        )
    }

    /// Settings of the planner: ours, or those of the paper, which has no information gain and
    /// excludes no more than the visited views themselves.
    pub(super) fn config(self, ours: &Config) -> Config {
        if matches!(self, Self::Greedy | Self::GreedyTruth) {
            return *ours;
        }
        Config {
            sigma_share: PAPER_SIGMA_SHARE,
            visited_share: 0.0,
            gain_weight: 0.0,
            ..*ours
        }
    }

    /// `true` if the method looks at the unknown space.
    pub(super) fn needs_occupancy(self, config: &Config) -> bool {
        self == Self::InformationGain || self.config(config).gain_weight > 0.0
    }
}
