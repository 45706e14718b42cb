//! Recognition result and the rule for unknown objects.

use crate::{CategoryName, NoveltyPrior, ViewId};

/// Number of nearest categories in a result.
pub const N_NEAREST: usize = 4;

/// Rejection rule of open-set recognition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnknownRule {
    /// Unknown if the nearest view is farther than this distance, as in the paper of
    /// GOOD.
    FartherThan(f32),
    /// Unknown if the best category is less probable than this. Without a calibration every object
    /// is known.
    LessProbableThan {
        /// Least probability of the best category, 0 to 1.
        probability: f32,
        /// Prior probability that an object is of no taught category, 0 to 1.
        novelty_prior: f32,
    },
}

impl UnknownRule {
    /// Prior of novelty that the probabilities reckon with.
    pub(crate) fn novelty_prior(self) -> f32 {
        match self {
            Self::FartherThan(_) => NoveltyPrior::default().probability(),
            Self::LessProbableThan { novelty_prior, .. } => novelty_prior,
        }
    }
}

impl From<f32> for UnknownRule {
    fn from(threshold: f32) -> Self {
        Self::FartherThan(threshold)
    }
}

/// Recognition result with its evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognition {
    /// Best category; `None` when the object is rejected as unknown or nothing was taught.
    pub label: Option<CategoryName>,
    /// Distance to the nearest view of that category, mean over the sides; infinite when
    /// nothing was taught.
    pub distance: f32,
    /// Novelty score of a calibrated index: negative logarithm of the probability.
    /// Infinite when nothing was taught.
    pub novelty: Option<f32>,
    /// Probability that the object belongs to the best category, 0 to 1; `None` without a
    /// calibration, 0 when nothing was taught.
    pub probability: Option<f32>,
    /// Probability that the object belongs to any taught category, 0 to 1; `None` without a
    /// calibration, 0 when nothing was taught.
    pub known_probability: Option<f32>,
    /// Number of different sides of the object that the answer rests on.
    pub n_sides: usize,
    /// Best categories with their nearest views, best first, before rejection; unused
    /// entries are `None`. Without a calibration the nearest are the best.
    pub nearest: [Option<Neighbour>; N_NEAREST],
}

/// Nearest stored view of a category.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbour {
    /// Id of the neighbouring view.
    pub view: ViewId,
    /// Category of the neighbouring view.
    pub category: CategoryName,
    /// Descriptor distance to the neighbouring view.
    pub distance: f32,
    /// Probability of the category, 0 to 1; `None` without a calibration.
    pub probability: Option<f32>,
}

impl Recognition {
    /// Answer of a calibrated index without views.
    pub(crate) fn of_nothing() -> Self {
        Self {
            label: None,
            distance: f32::INFINITY,
            novelty: Some(f32::INFINITY),
            probability: Some(0.0),
            known_probability: Some(0.0),
            n_sides: 0,
            nearest: [const { None }; N_NEAREST],
        }
    }
}
