//! Mean distance to the nearest neighbour within the same category.

use crate::ViewId;
use crate::calibration::DistanceSum;
use std::collections::{BTreeMap, BTreeSet};

/// Number of views of a category whose nearest neighbours are searched for. A mean over 256
/// views has a standard error of some 3 % of it.
const N_SAMPLED: usize = 256;

/// Views of a category with the nearest neighbours of a sample of them: those with the smallest
/// hashes of their descriptors (bottom-k sample, Cohen and Kaplan 2007). The sample depends on
/// the descriptors alone, so that neither the order of teaching nor the ids of the views matter.
/// Views of small categories are all in the sample.
///
/// *Complexity*: a change of one view costs at most [`N_SAMPLED`] comparisons on average, and
/// some thousand changes at once little more than comparing the sample with all views.
#[derive(Debug, Clone, Default)]
pub(super) struct IntraCategoryDistances {
    /// Views of the category, by hash.
    members: Vec<Member>,
    /// Nearest neighbours of the first members.
    nearest: Vec<Option<ScoredNeighbour>>,
    distances: DistanceSum,
}

/// View of a category with the hash of its descriptor, by which it is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Member {
    pub(super) hash: u64,
    pub(super) id: ViewId,
}

/// Nearest neighbour of a view, with the score of its comparison.
#[derive(Debug, Clone, Copy)]
struct ScoredNeighbour {
    id: ViewId,
    score: f32,
}

/// Comparison of views by their ids.
pub(super) trait ViewComparison {
    /// Descriptors of a view in all axis hypotheses.
    fn queries(&self, view: ViewId) -> Vec<Vec<f32>>;

    /// Least score of a view over the queries, unless it is greater than `bound`.
    fn bounded_score(&self, queries: &[Vec<f32>], view: ViewId, bound: f32) -> Option<f32>;

    /// Distance of a score.
    fn distance(&self, score: f32) -> f32;
}

impl IntraCategoryDistances {
    /// Removes views, then adds others, and compares what that concerns.
    pub(super) fn update(
        &mut self,
        removed: &BTreeSet<ViewId>,
        added: &[Member],
        comparison: &impl ViewComparison,
    ) {
        let kept = self.neighbours_left(removed);
        self.members.retain(|member| !removed.contains(&member.id));
        self.members.extend(added);
        self.members.sort_unstable();
        let sample = &self.members[..self.members.len().min(N_SAMPLED)];
        self.nearest.clear();
        self.nearest
            .extend(sample.iter().map(|member| match kept.get(&member.id) {
                Some(neighbour) => *neighbour,
                None => nearest_neighbour(member.id, &self.members, comparison),
            }));
        for new in added {
            let queries = comparison.queries(new.id);
            for (member, nearest) in sample.iter().zip(&mut self.nearest) {
                if kept.contains_key(&member.id) {
                    // The distance is symmetric: the queries of one view serve for all others.
                    keep_nearer(nearest, new.id, |bound| {
                        comparison.bounded_score(&queries, member.id, bound)
                    });
                }
            }
        }
        self.distances = self.estimate(comparison);
    }

    /// Nearest neighbours that remain without some views; without an entry for the views whose
    /// neighbour is among those.
    fn neighbours_left(
        &self,
        removed: &BTreeSet<ViewId>,
    ) -> BTreeMap<ViewId, Option<ScoredNeighbour>> {
        let is_left = |id| !removed.contains(&id);
        self.members
            .iter()
            .zip(&self.nearest)
            .filter(|(member, nearest)| {
                is_left(member.id) && nearest.is_none_or(|neighbour| is_left(neighbour.id))
            })
            .map(|(member, nearest)| (member.id, *nearest))
            .collect()
    }

    /// Sum of the nearest-neighbour distances of all members, estimated from the sample.
    fn estimate(&self, comparison: &impl ViewComparison) -> DistanceSum {
        let scores = self.nearest.iter().flatten();
        let distances = scores.map(|neighbour| f64::from(comparison.distance(neighbour.score)));
        let (mut sum, mut n_sampled) = (0.0, 0);
        for distance in distances {
            sum += distance;
            n_sampled += 1;
        }
        if n_sampled == 0 {
            return DistanceSum::default();
        }
        let n = self.members.len();
        DistanceSum {
            sum: sum * (n as f64 / f64::from(n_sampled)),
            n,
        }
    }

    /// Sum and count of the nearest-neighbour distances.
    pub(super) fn distances(&self) -> DistanceSum {
        self.distances
    }
}

/// Nearest neighbour of a view among the other members.
fn nearest_neighbour(
    view: ViewId,
    members: &[Member],
    comparison: &impl ViewComparison,
) -> Option<ScoredNeighbour> {
    let queries = comparison.queries(view);
    let mut nearest = None;
    for other in members.iter().filter(|other| other.id != view) {
        keep_nearer(&mut nearest, other.id, |bound| {
            comparison.bounded_score(&queries, other.id, bound)
        });
    }
    nearest
}

/// Replaces a nearest neighbour by another view if that is nearer; `bounded_score` gives its
/// score unless that is greater than a bound.
fn keep_nearer(
    nearest: &mut Option<ScoredNeighbour>,
    id: ViewId,
    bounded_score: impl Fn(f32) -> Option<f32>,
) {
    let bound = nearest.map_or(f32::INFINITY, |neighbour| neighbour.score);
    if let Some(score) = bounded_score(bound)
        && nearest.is_none_or(|neighbour| score < neighbour.score)
    {
        *nearest = Some(ScoredNeighbour { id, score });
    }
}

#[cfg(test)]
mod tests;
