//! Distances to the nearest neighbour within the same category.

use crate::ViewId;
use crate::calibration::DistanceSum;

/// Views of a category with their nearest neighbours within it. Independent of the
/// insertion order, except for rounding of the sum.
#[derive(Debug, Clone, Default)]
pub(super) struct IntraCategoryDistances {
    members: Vec<Member>,
    distances: DistanceSum,
}

/// View with its nearest neighbour in the category.
#[derive(Debug, Clone, Copy)]
struct Member {
    id: ViewId,
    nearest: Option<NeighbourDistance>,
}

/// Nearest neighbouring view and its distance.
pub(super) type NeighbourDistance = (ViewId, f32);

impl IntraCategoryDistances {
    /// Adds a view and updates the nearest-neighbour distances of the category; `distance` returns
    /// the distance from it to another view.
    pub(super) fn add(&mut self, id: ViewId, mut distance: impl FnMut(ViewId) -> f32) {
        let mut nearest = None;
        for member in &mut self.members {
            let distance = distance(member.id);
            nearest = nearer(nearest, (member.id, distance));
            let before = member.nearest;
            member.nearest = nearer(before, (id, distance));
            self.distances
                .replace(distance_of(before), distance_of(member.nearest));
        }
        self.distances.replace(None, distance_of(nearest));
        self.members.push(Member { id, nearest });
    }

    /// Removes a view. Views whose nearest neighbour it was search for another one among
    /// the rest with `nearest_of`.
    pub(super) fn remove(
        &mut self,
        id: ViewId,
        mut nearest_of: impl FnMut(ViewId, &[ViewId]) -> Option<NeighbourDistance>,
    ) {
        let Some(place) = self.members.iter().position(|member| member.id == id) else {
            return;
        };
        let removed = self.members.swap_remove(place);
        self.distances.replace(distance_of(removed.nearest), None);
        let mut others = Vec::new();
        for i in 0..self.members.len() {
            let Member { id: left, nearest } = self.members[i];
            if nearest.is_none_or(|(neighbour, _)| neighbour != id) {
                continue;
            }
            let ids = self.members.iter().map(|member| member.id);
            others.clear();
            others.extend(ids.filter(|&other| other != left));
            let found = nearest_of(left, &others);
            self.members[i].nearest = found;
            self.distances
                .replace(distance_of(nearest), distance_of(found));
        }
    }

    /// Sum and count of the nearest-neighbour distances.
    pub(super) fn distances(&self) -> DistanceSum {
        self.distances
    }
}

/// Distance to the nearest neighbour; infinite without one.
fn distance_of(nearest: Option<NeighbourDistance>) -> Option<f32> {
    nearest.map(|(_, distance)| distance)
}

/// Nearer of two neighbours of a view.
pub(super) fn nearer(
    present: Option<NeighbourDistance>,
    other: NeighbourDistance,
) -> Option<NeighbourDistance> {
    let is_nearer = present.is_none_or(|(_, distance)| other.1 < distance);
    if is_nearer { Some(other) } else { present }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn id(view_id: u32) -> ViewId {
        ViewId {
            track_id: 1,
            view_id,
        }
    }

    fn distance(places: &[f32], a: ViewId, b: ViewId) -> f32 {
        (places[a.view_id as usize] - places[b.view_id as usize]).abs()
    }

    proptest! {
        #[test]
        fn distances_after_any_changes_are_those_of_the_remaining_views(
            places in prop::collection::vec(0.0_f32..9.0, 1..12),
            removed in prop::collection::vec(any::<bool>(), 12),
        ) {
            let n = places.len() as u32;
            let mut spread = IntraCategoryDistances::default();
            for view in 0..n {
                spread.add(id(view), |other| distance(&places, id(view), other));
            }
            let mut left = Vec::new();
            for view in 0..n {
                if removed[view as usize] {
                    spread.remove(id(view), |a, others| {
                        let near = |b: &ViewId| (*b, distance(&places, a, *b));
                        others.iter().map(near).fold(None, nearer)
                    });
                } else {
                    left.push(view);
                }
            }
            let nearest = |view: &u32| {
                let others = left.iter().filter(|other| *other != view);
                let distances = others.map(|other| distance(&places, id(*view), id(*other)));
                distances.reduce(f32::min)
            };
            let expected: Vec<f32> = left.iter().filter_map(nearest).collect();
            let found = spread.distances();
            prop_assert_eq!(found.n, expected.len());
            let sum: f64 = expected.into_iter().map(f64::from).sum();
            prop_assert!((found.sum - sum).abs() < 1e-6);
        }
    }
}
