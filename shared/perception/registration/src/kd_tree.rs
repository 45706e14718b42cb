//! k-d tree: nearest neighbours of points in space.

/// Number of points in a leaf, at most. Chosen.
const LEAF_LEN: usize = 8;

/// Balanced k-d tree over points, split at the median of the longest side of their box.
#[derive(Debug, Clone)]
pub struct KdTree {
    /// Points in the order of the leaves.
    points: Vec<[f32; 3]>,
    /// Index that each of them had.
    indices: Vec<u32>,
    /// Inner nodes in heap order: the children of node `i` are `2 i` and `2 i + 1`; the root is 1.
    nodes: Vec<Split>,
    depth: u32,
}

/// Plane across an axis that divides the points of a node.
#[derive(Debug, Clone, Copy, Default)]
struct Split {
    axis: u8,
    coordinate: f32,
}

/// Part of the tree that a search visits.
#[derive(Debug, Clone, Copy)]
struct Visit {
    node: usize,
    level: u32,
    first: usize,
    end: usize,
    /// Squared distance that the points have to exceed.
    squared_min: f32,
    /// Distance to the node's region along each axis.
    offset: [f32; 3],
    squared_offset: f32,
}

impl KdTree {
    /// Tree over points.
    pub fn new(points: &[[f32; 3]]) -> Self {
        let mut depth = 0;
        while points.len() >> depth > LEAF_LEN {
            depth += 1;
        }
        let mut indices: Vec<u32> = (0..points.len() as u32).collect();
        let mut nodes = vec![Split::default(); 1 << depth];
        split(points, &mut indices, &mut nodes, 1, depth);
        Self {
            points: indices.iter().map(|&i| points[i as usize]).collect(),
            indices,
            nodes,
            depth,
        }
    }

    /// Index of the nearest point within a distance, with the squared distance.
    pub fn nearest(&self, place: [f32; 3], squared_reach: f32) -> Option<(usize, f32)> {
        let mut best = (usize::MAX, squared_reach);
        self.visit(place, self.whole(-1.0), &mut best);
        let index = self.indices.get(best.0)?;
        Some((*index as usize, best.1))
    }

    /// Squared distance from a place to the nearest point elsewhere.
    pub(crate) fn nearest_elsewhere(&self, place: [f32; 3]) -> Option<f32> {
        let mut best = (usize::MAX, f32::INFINITY);
        self.visit(place, self.whole(0.0), &mut best);
        best.1.is_finite().then_some(best.1)
    }

    /// Visit of all points farther than a squared distance.
    fn whole(&self, squared_min: f32) -> Visit {
        Visit {
            node: 1,
            level: 0,
            first: 0,
            end: self.points.len(),
            squared_min,
            offset: [0.0; 3],
            squared_offset: 0.0,
        }
    }

    fn visit(&self, place: [f32; 3], visit: Visit, best: &mut (usize, f32)) {
        if visit.level == self.depth {
            for (i, point) in (visit.first..).zip(&self.points[visit.first..visit.end]) {
                let (x, y, z) = (
                    point[0] - place[0],
                    point[1] - place[1],
                    point[2] - place[2],
                );
                let squared = x * x + y * y + z * z;
                if squared < best.1 && squared > visit.squared_min {
                    *best = (i, squared);
                }
            }
            return;
        }
        let Split { axis, coordinate } = self.nodes[visit.node];
        let axis = usize::from(axis);
        let middle = visit.first + (visit.end - visit.first) / 2;
        let beyond = place[axis] - coordinate;
        let [lower, upper] =
            [(0, visit.first, middle), (1, middle, visit.end)].map(|(child, first, end)| Visit {
                node: 2 * visit.node + child,
                level: visit.level + 1,
                first,
                end,
                ..visit
            });
        let (near, mut far) = if beyond < 0.0 {
            (lower, upper)
        } else {
            (upper, lower)
        };
        self.visit(place, near, best);
        far.squared_offset += beyond * beyond - far.offset[axis] * far.offset[axis];
        far.offset[axis] = beyond;
        if far.squared_offset < best.1 {
            self.visit(place, far, best);
        }
    }
}

/// Orders the indices of a node's points by leaves and writes the planes between them.
fn split(points: &[[f32; 3]], indices: &mut [u32], nodes: &mut [Split], node: usize, depth: u32) {
    if depth == 0 {
        return;
    }
    let coordinate = |index: u32, axis: usize| points[index as usize][axis];
    let side = |axis: usize| {
        let values = indices.iter().map(|&index| coordinate(index, axis));
        let bounds = (f32::INFINITY, f32::NEG_INFINITY);
        let (low, high) = values.fold(bounds, |(l, h), v| (v.min(l), v.max(h)));
        high - low
    };
    let sides = [side(0), side(1), side(2)];
    let axis = (1..3).fold(0, |longest, axis| {
        if sides[axis] > sides[longest] {
            axis
        } else {
            longest
        }
    });
    let middle = indices.len() / 2;
    let by_coordinate = |a: &u32, b: &u32| coordinate(*a, axis).total_cmp(&coordinate(*b, axis));
    let (_, &mut median, _) = indices.select_nth_unstable_by(middle, by_coordinate);
    nodes[node] = Split {
        axis: axis as u8,
        coordinate: coordinate(median, axis),
    };
    let (lower, upper) = indices.split_at_mut(middle);
    split(points, lower, nodes, 2 * node, depth - 1);
    split(points, upper, nodes, 2 * node + 1, depth - 1);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = [f32; 3]> {
        prop::array::uniform3((-8_i8..8).prop_map(|v| f32::from(v) / 4.0))
    }

    fn squared(a: [f32; 3], b: [f32; 3]) -> f32 {
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
    }

    proptest! {
        #[test]
        fn nearest_point_is_that_of_an_exhaustive_search(
            points in prop::collection::vec(point(), 0..120),
            place in point(),
            reach in 0.0_f32..3.0,
        ) {
            let found = KdTree::new(&points).nearest(place, reach);
            let distances = points.iter().map(|p| squared(*p, place)).filter(|d| *d < reach);
            let expected = distances.fold(None, |least: Option<f32>, d| {
                Some(least.map_or(d, |least| least.min(d)))
            });
            prop_assert_eq!(found.map(|(_, d)| d), expected);
            if let Some((index, d)) = found {
                prop_assert_eq!(squared(points[index], place), d);
            }
            let elsewhere = points.iter().map(|p| squared(*p, place)).filter(|d| *d > 0.0);
            let nearest = KdTree::new(&points).nearest_elsewhere(place);
            prop_assert_eq!(nearest, elsewhere.reduce(f32::min));
        }
    }
}
