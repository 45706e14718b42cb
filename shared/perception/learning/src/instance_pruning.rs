//! Instance pruning: removal of the most redundant views of a category.
//!
//! The older view of the closest pair is removed repeatedly, because the newer one shows
//! the object's present state. Duplicates are removed first and outliers last.

use crate::{Error, Metric};

const METRIC: Metric = Metric::Euclidean;

/// Indices of the `n_to_drop` most redundant views, in order of removal; all indices if
/// there are fewer views.
///
/// `descriptors` are those of one category, oldest first. In each round the older view
/// of the pair with the least Euclidean distance is removed; among equal pairs the one
/// whose older view is oldest. The newest view is removed last.
///
/// *Complexity*: all pairs are compared once; after a removal, the views whose nearest
/// neighbour it was are compared again with the remaining ones.
///
/// # Errors
/// When the descriptors differ in length, or a value is not finite or beyond 1e6.
pub fn redundant_views(
    descriptors: &[impl AsRef<[f32]>],
    n_to_drop: usize,
) -> Result<Vec<usize>, Error> {
    let dimension = descriptors.first().map_or(0, |first| first.as_ref().len());
    for descriptor in descriptors {
        METRIC.check(descriptor.as_ref(), dimension)?;
    }
    if n_to_drop == 0 {
        return Ok(Vec::new());
    }
    let mut remaining = RemainingViews::new(descriptors);
    Ok((0..n_to_drop)
        .map_while(|_| remaining.remove_most_redundant())
        .collect())
}

/// Nearest neighbour of a descriptor among the newer ones.
#[derive(Debug, Clone, Copy)]
struct NearestNewer {
    /// Score ordered like the distance; infinite for the newest remaining view.
    score: f32,
    newer_idx: Option<usize>,
}

/// Remaining descriptors and their nearest newer neighbours.
struct RemainingViews<'a, D> {
    descriptors: &'a [D],
    /// Nearest newer neighbour per descriptor; `None` after its removal. A pair is
    /// stored at its older member, the one to be removed.
    nearest: Vec<Option<NearestNewer>>,
}

impl<'a, D: AsRef<[f32]>> RemainingViews<'a, D> {
    fn new(descriptors: &'a [D]) -> Self {
        let unknown = NearestNewer {
            score: f32::INFINITY,
            newer_idx: None,
        };
        let mut remaining = Self {
            descriptors,
            nearest: vec![Some(unknown); descriptors.len()],
        };
        for idx in 0..descriptors.len() {
            remaining.nearest[idx] = Some(remaining.nearest_newer(idx));
        }
        remaining
    }

    /// Removes the older view of the closest pair and returns its index; `None` when no
    /// view remains.
    fn remove_most_redundant(&mut self) -> Option<usize> {
        let remaining = (0..).zip(&self.nearest);
        let scores = remaining.filter_map(|(idx, nearest)| Some((idx, nearest.as_ref()?.score)));
        // `min_by` returns the first of equal scores.
        let (removed, _) = scores.min_by(|a, b| a.1.total_cmp(&b.1))?;
        self.nearest[removed] = None;
        for idx in 0..removed {
            if self.nearest[idx].is_some_and(|nearest| nearest.newer_idx == Some(removed)) {
                self.nearest[idx] = Some(self.nearest_newer(idx));
            }
        }
        Some(removed)
    }

    fn nearest_newer(&self, idx: usize) -> NearestNewer {
        let of = self.descriptors[idx].as_ref();
        let mut nearest = NearestNewer {
            score: f32::INFINITY,
            newer_idx: None,
        };
        for newer in idx + 1..self.descriptors.len() {
            if self.nearest[newer].is_none() {
                continue;
            }
            let other = self.descriptors[newer].as_ref();
            let score = METRIC.bounded_score(of, other, nearest.score);
            if let Some(score) = score.filter(|score| *score < nearest.score) {
                nearest = NearestNewer {
                    score,
                    newer_idx: Some(newer),
                };
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests;
