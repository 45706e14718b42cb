//! The answer to "what is this?".

use crate::{CategoryName, ViewId};

/// Most categories named in an answer.
pub const N_NEAREST: usize = 4;

/// When an object is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnknownRule {
    /// When the nearest view is farther than this, as in the paper.
    FartherThan(f32),
    /// When the probability that it belongs to the nearest category is less than
    /// this, 0 to 1. Without a calibration nothing is unknown.
    LessProbableThan(f32),
}

impl From<f32> for UnknownRule {
    fn from(threshold: f32) -> Self {
        Self::FartherThan(threshold)
    }
}

/// What an object was recognised as, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognition {
    /// The category of the nearest view; `None` when the rule says "unknown", or
    /// nothing was taught.
    pub label: Option<CategoryName>,
    /// Distance of the nearest view; infinite when nothing was taught.
    pub distance: f32,
    /// How new the object is to an index with a calibration: the greater, the less
    /// likely it belongs to any category that was taught; infinite when nothing was.
    pub novelty: Option<f32>,
    /// The probability that it belongs to the nearest category, 0 to 1, by the
    /// calibration of the index.
    pub probability: Option<f32>,
    /// The nearest view of each of the nearest categories, nearest first, whatever
    /// the rule; `None` behind the last one.
    pub nearest: [Option<Neighbour>; N_NEAREST],
}

/// The view of a category that is most similar to what was asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbour {
    /// The view.
    pub view: ViewId,
    /// Its category.
    pub category: CategoryName,
    /// Its distance.
    pub distance: f32,
}
