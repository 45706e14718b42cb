//! The answer to "what is this?".

use crate::{CategoryName, ViewId};

/// Most categories named in an answer.
pub const N_NEAREST: usize = 4;

/// What an object was recognised as, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognition {
    /// The category of the nearest view; `None` when even that one is farther than
    /// the threshold, or nothing was taught.
    pub label: Option<CategoryName>,
    /// Distance of the nearest view; infinite when nothing was taught.
    pub distance: f32,
    /// The nearest view of each of the nearest categories, nearest first, whatever
    /// the threshold; `None` behind the last one.
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
