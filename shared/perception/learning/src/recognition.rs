//! Recognition result and the rule for unknown objects.

use crate::{CategoryName, ViewId};

/// Number of nearest categories in a result.
pub const N_NEAREST: usize = 4;

/// Rejection rule of open-set recognition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnknownRule {
    /// Unknown if the nearest view is farther than this distance, as in the paper of
    /// GOOD.
    FartherThan(f32),
    /// Unknown if the probability of the nearest category is below this value, 0 to 1.
    /// Without a calibration every object is known.
    LessProbableThan(f32),
}

impl From<f32> for UnknownRule {
    fn from(threshold: f32) -> Self {
        Self::FartherThan(threshold)
    }
}

/// Recognition result with its evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognition {
    /// Category of the nearest view; `None` when the object is rejected as unknown or
    /// nothing was taught.
    pub label: Option<CategoryName>,
    /// Distance to the nearest view; infinite when nothing was taught.
    pub distance: f32,
    /// Novelty score of a calibrated index: the larger, the less likely the object
    /// belongs to a taught category. Infinite when nothing was taught.
    pub novelty: Option<f32>,
    /// Probability that the object belongs to the nearest category, 0 to 1; `None`
    /// without a calibration.
    pub probability: Option<f32>,
    /// Nearest view of each of the nearest categories, nearest first, before rejection;
    /// unused entries are `None`.
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
}
