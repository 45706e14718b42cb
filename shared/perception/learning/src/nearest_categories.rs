//! The nearest view of each of the nearest categories, while views pass by.

use crate::ViewId;
use crate::recognition::N_NEAREST;

/// A view that was compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    /// Orders candidates as their distances do.
    pub(crate) score: f32,
    /// Decides between equal scores.
    pub(crate) view: ViewId,
    /// Number of its category.
    pub(crate) category: u64,
    /// Row of its descriptor.
    pub(crate) row: usize,
}

impl Candidate {
    fn is_before(&self, other: &Self) -> bool {
        self.score
            .total_cmp(&other.score)
            .then(self.view.cmp(&other.view))
            .is_lt()
    }
}

/// At most [`N_NEAREST`] candidates of different categories, nearest first.
///
/// A category that was pushed out needs no memory: what pushed it out is nearer
/// than all it had, so only a nearer view can bring it back.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NearestCategories {
    candidates: [Option<Candidate>; N_NEAREST],
}

impl NearestCategories {
    /// The candidates, nearest first.
    pub(crate) fn candidates(&self) -> [Option<Candidate>; N_NEAREST] {
        self.candidates
    }

    /// The largest score with which a view of the category can still matter.
    #[inline]
    pub(crate) fn bound(&self, category: u64) -> f32 {
        self.candidates[self.place_of(category)].map_or(f32::INFINITY, |present| present.score)
    }

    /// The largest score with which a view of any category can still matter.
    #[inline]
    pub(crate) fn farthest(&self) -> f32 {
        self.candidates[N_NEAREST - 1].map_or(f32::INFINITY, |last| last.score)
    }

    /// Takes a candidate if it is nearer than what is there; says whether it is.
    pub(crate) fn offer(&mut self, candidate: Candidate) -> bool {
        let mut place = self.place_of(candidate.category);
        if self.candidates[place].is_some_and(|present| !candidate.is_before(&present)) {
            return false;
        }
        self.candidates[place] = Some(candidate);
        while place > 0 && self.candidates[place - 1].is_some_and(|c| candidate.is_before(&c)) {
            self.candidates.swap(place - 1, place);
            place -= 1;
        }
        true
    }

    /// Where the category is, else the first free place, else the last one.
    #[inline]
    fn place_of(&self, category: u64) -> usize {
        self.candidates
            .iter()
            .position(|place| place.is_none_or(|present| present.category == category))
            .unwrap_or(N_NEAREST - 1)
    }
}
