//! Top-k categories with their nearest view, updated while views are compared.

use crate::ViewId;
use crate::recognition::N_NEAREST;
use std::collections::BTreeMap;

/// View with the score of its comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScoredView {
    /// Score that orders views like the distance does.
    pub(crate) score: f32,
    /// Id of the view, which breaks ties.
    pub(crate) view: ViewId,
    /// Number of the view's category.
    pub(crate) category: u64,
    /// Row of the view in the view table.
    pub(crate) row: usize,
}

impl ScoredView {
    pub(crate) fn precedes(&self, other: &Self) -> bool {
        self.score
            .total_cmp(&other.score)
            .then(self.view.cmp(&other.view))
            .is_lt()
    }
}

/// List of nearest views that a search fills.
pub(crate) trait NearestList {
    /// Largest score with which a view of the category can still change the list.
    fn bound(&self, category: u64) -> f32;

    /// Largest score with which a view of any category can still change the list.
    fn worst_score(&self) -> f32;

    /// Inserts a view unless it is too far.
    fn offer(&mut self, scored: ScoredView);
}

/// Top-k list: the nearest view of each of the [`N_NEAREST`] nearest categories, nearest
/// first.
///
/// A category that leaves the list needs no record: its views were all farther than the
/// list's last entry, so only a nearer view can bring it back.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NearestCategories {
    views: [Option<ScoredView>; N_NEAREST],
}

impl NearestCategories {
    /// Nearest view of each of the nearest categories, nearest first.
    pub(crate) fn views(&self) -> [Option<ScoredView>; N_NEAREST] {
        self.views
    }

    /// Slot of the category, else the first free slot, else the last one.
    #[inline]
    fn slot_of(&self, category: u64) -> usize {
        self.views
            .iter()
            .position(|slot| slot.is_none_or(|present| present.category == category))
            .unwrap_or(N_NEAREST - 1)
    }
}

/// Nearest view of each category.
#[derive(Debug, Clone, Default)]
pub(crate) struct CategoryMinima {
    /// Nearest views by category number.
    pub(crate) views: BTreeMap<u64, ScoredView>,
}

impl NearestList for CategoryMinima {
    fn bound(&self, category: u64) -> f32 {
        let present = self.views.get(&category);
        present.map_or(f32::INFINITY, |present| present.score)
    }

    fn worst_score(&self) -> f32 {
        f32::INFINITY
    }

    fn offer(&mut self, scored: ScoredView) {
        let present = self.views.entry(scored.category).or_insert(scored);
        if scored.precedes(present) {
            *present = scored;
        }
    }
}

impl NearestList for NearestCategories {
    #[inline]
    fn bound(&self, category: u64) -> f32 {
        self.views[self.slot_of(category)].map_or(f32::INFINITY, |present| present.score)
    }

    #[inline]
    fn worst_score(&self) -> f32 {
        self.views[N_NEAREST - 1].map_or(f32::INFINITY, |last| last.score)
    }

    fn offer(&mut self, scored: ScoredView) {
        let mut slot = self.slot_of(scored.category);
        if self.views[slot].is_some_and(|present| !scored.precedes(&present)) {
            return;
        }
        self.views[slot] = Some(scored);
        while slot > 0 && self.views[slot - 1].is_some_and(|c| scored.precedes(&c)) {
            self.views.swap(slot - 1, slot);
            slot -= 1;
        }
    }
}
