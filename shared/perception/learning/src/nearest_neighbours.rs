//! K-nearest-neighbour list, updated while views are compared.

use crate::nearest_categories::{NearestList, ScoredView};

/// The nearest views of a description over all categories, nearest first, each with its
/// least score.
#[derive(Debug, Clone, Default)]
pub(crate) struct NearestNeighbours {
    capacity: usize,
    views: Vec<ScoredView>,
}

impl NearestNeighbours {
    /// Empty list of at most `capacity` views.
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            capacity,
            views: Vec::with_capacity(capacity + 1),
        }
    }

    /// Nearest views, nearest first; ties are broken by the smaller view id.
    pub(crate) fn views(&self) -> &[ScoredView] {
        &self.views
    }
}

impl NearestList for NearestNeighbours {
    #[inline]
    fn bound(&self, _category: u64) -> f32 {
        self.worst_score()
    }

    #[inline]
    fn worst_score(&self) -> f32 {
        match self.views.last() {
            Some(last) if self.views.len() == self.capacity => last.score,
            _ => f32::INFINITY,
        }
    }

    fn offer(&mut self, scored: ScoredView) {
        let is_same = |present: &ScoredView| present.view == scored.view;
        if let Some(place) = self.views.iter().position(is_same) {
            if !scored.precedes(&self.views[place]) {
                return;
            }
            self.views.remove(place);
        }
        let place = self
            .views
            .partition_point(|present| present.precedes(&scored));
        if place < self.capacity {
            self.views.insert(place, scored);
            self.views.truncate(self.capacity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ViewId;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn list_equals_the_sorted_least_scores(
            offers in prop::collection::vec((0_u64..12, 0_u8..20), 0..60),
            capacity in 1_usize..8,
        ) {
            let mut list = NearestNeighbours::new(capacity);
            let mut least = std::collections::BTreeMap::new();
            for (track_id, score) in offers {
                let view = ViewId { track_id, view_id: 0 };
                list.offer(ScoredView { score: f32::from(score), view, category: 0, row: 0 });
                let present = least.entry(view).or_insert(score);
                *present = score.min(*present);
            }
            let mut expected: Vec<_> = least.into_iter().map(|(view, score)| (score, view)).collect();
            expected.sort_unstable();
            expected.truncate(capacity);
            let found: Vec<_> = list.views().iter().map(|v| (v.score as u8, v.view)).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
