//! Voxel clusters: connected components of occupied cells above the table.

use super::label_groups::{LabelGroups, UNLABELLED};
use super::voxel_grid::VoxelGrid;
use crate::affine_form::AffineForm;
use point_cloud::Point;
use union_find::{find_root, union};

/// Horizontal cells grown per vertical cell, so that stacked parts are separated at a
/// level. Chosen.
const HORIZONTAL_REACH: usize = 3;

/// Number of growth fronts: one more than the longest step.
const N_FRONTS: usize = HORIZONTAL_REACH + 1;

/// Voxel clusters found last, with buffers.
#[derive(Debug, Default)]
pub(super) struct VoxelClusters {
    parents: Vec<u32>,
    n_cells: Vec<u32>,
    cluster_of_cell: Vec<u32>,
    of_point: Vec<u32>,
    groups: LabelGroups,
    fronts: [Vec<u32>; N_FRONTS],
}

impl VoxelClusters {
    /// Label the connected components of the listed points, which are then known by their
    /// position in the list. Touching cells of side `cell_m`, metres, are connected: points
    /// closer than one cell always, points across more than one empty cell never.
    /// Components with fewer than `n_min` cells are dropped.
    pub(super) fn label_components(
        &mut self,
        points: &[Point],
        listed: &[u32],
        table_axes: &[AffineForm; 3],
        (cell_m, n_min): (f32, u32),
        voxels: &mut VoxelGrid,
    ) {
        let in_table = |k: usize| {
            let point = &points[listed[k] as usize];
            Some([0, 1, 2].map(|axis: usize| table_axes[axis].at(point.x, point.y, point.z)))
        };
        voxels.fill(listed.len(), in_table, cell_m);
        self.parents.clear();
        self.parents.extend(0..voxels.len() as u32);
        for cell in 0..voxels.len() {
            for near in voxels.later_neighbours(cell) {
                union(&mut self.parents, cell as u32, near as u32);
            }
        }
        let n_clusters = self.number_large(n_min);
        self.group_points(n_clusters, voxels);
    }

    /// Number the large components in the order of their first cells.
    fn number_large(&mut self, n_min: u32) -> u32 {
        let n_cells = self.parents.len();
        self.n_cells.clear();
        self.n_cells.resize(n_cells, 0);
        for cell in 0..n_cells as u32 {
            self.n_cells[find_root(&mut self.parents, cell) as usize] += 1;
        }
        let mut n_clusters = 0;
        self.cluster_of_cell.clear();
        for cell in 0..n_cells as u32 {
            let first = find_root(&mut self.parents, cell);
            let cluster = if first != cell {
                self.cluster_of_cell[first as usize]
            } else if self.n_cells[cell as usize] >= n_min {
                n_clusters += 1;
                n_clusters - 1
            } else {
                UNLABELLED
            };
            self.cluster_of_cell.push(cluster);
        }
        n_clusters
    }

    fn group_points(&mut self, n_clusters: u32, voxels: &VoxelGrid) {
        self.of_point.clear();
        let cluster = |&cell: &u32| match cell {
            UNLABELLED => UNLABELLED,
            cell => self.cluster_of_cell[cell as usize],
        };
        self.of_point.extend(voxels.voxel_of().iter().map(cluster));
        self.groups.refill(&self.of_point, n_clusters as usize);
    }

    /// Number of voxel clusters.
    pub(super) fn len(&self) -> usize {
        self.groups.len()
    }

    /// Positions of a cluster's points in the list.
    pub(super) fn members(&self, cluster: usize) -> &[u32] {
        self.groups.members(cluster)
    }

    /// Regroup the points after splits changed their labels.
    pub(super) fn regroup(&mut self, n_clusters: usize) {
        self.groups.refill(&self.of_point, n_clusters);
    }

    /// Split a cluster. `part_of` gives the part of each member; members without one take
    /// the part that grows to their cell first. Part 0 keeps the cluster's number, the
    /// others are numbered from `next`. Groups change only at [`Self::regroup`].
    pub(super) fn split(&mut self, cluster: usize, part_of: &[u32], next: u32, voxels: &VoxelGrid) {
        let Self {
            of_point,
            groups,
            cluster_of_cell,
            fronts,
            ..
        } = self;
        let own = cluster as u32;
        let number = |part: u32| if part == 0 { own } else { next + part - 1 };
        let members = groups.members(cluster);
        let cell_of = |member: u32| voxels.voxel_of()[member as usize] as usize;
        // Cells not reached yet have no cluster.
        for &member in members {
            cluster_of_cell[cell_of(member)] = UNLABELLED;
        }
        for (&member, &part) in members.iter().zip(part_of) {
            let cell = cell_of(member);
            if part != UNLABELLED && cluster_of_cell[cell] == UNLABELLED {
                cluster_of_cell[cell] = number(part);
                fronts[0].push(cell as u32);
            }
        }
        grow(cluster_of_cell, fronts, voxels);
        for (&member, &part) in members.iter().zip(part_of) {
            of_point[member as usize] = match part {
                UNLABELLED => cluster_of_cell[cell_of(member)],
                part => number(part),
            };
        }
    }
}

/// Region growing from the cells of the first front over connected unlabelled cells,
/// nearest first (bucket queue, Dial 1969). All neighbours of a cluster's cells join it.
fn grow(cluster_of_cell: &mut [u32], fronts: &mut [Vec<u32>; N_FRONTS], voxels: &VoxelGrid) {
    // A claim is a pair of a cell and the cell from which it is reached; it is settled on
    // arrival.
    let reach = |cell: usize, distance: usize, fronts: &mut [Vec<u32>; N_FRONTS], of: &[u32]| {
        for (near, [_, _, up]) in voxels.neighbours(cell) {
            if of[near] == UNLABELLED {
                let steps = if up == 0 { 1 } else { HORIZONTAL_REACH };
                fronts[(distance + steps) % N_FRONTS].extend([near as u32, cell as u32]);
            }
        }
    };
    let mut front = std::mem::take(&mut fronts[0]);
    for &cell in &front {
        reach(cell as usize, 0, fronts, cluster_of_cell);
    }
    let (mut distance, mut n_empty) = (0, 0);
    while n_empty < N_FRONTS {
        distance += 1;
        front.clear();
        std::mem::swap(&mut front, &mut fronts[distance % N_FRONTS]);
        n_empty = if front.is_empty() { n_empty + 1 } else { 0 };
        for claim in front.chunks_exact(2) {
            let (cell, from) = (claim[0] as usize, claim[1] as usize);
            if cluster_of_cell[cell] == UNLABELLED {
                cluster_of_cell[cell] = cluster_of_cell[from];
                reach(cell, distance, fronts, cluster_of_cell);
            }
        }
    }
    front.clear();
    fronts[0] = front;
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use point_cloud::Rgba;
    use proptest::prelude::*;

    const CELL_M: f32 = 0.006;

    fn at(x: f32, y: f32, z: f32) -> Point {
        Point {
            x,
            y,
            z,
            color: Rgba::default(),
        }
    }

    fn joined(points: &[Point]) -> (VoxelClusters, VoxelGrid) {
        let listed: Vec<u32> = (0..points.len() as u32).collect();
        let axes = AffineForm::coordinates_of(&RigidTransform::identity());
        let (mut clusters, mut voxels) = (VoxelClusters::default(), VoxelGrid::default());
        clusters.label_components(points, &listed, &axes, (CELL_M, 1), &mut voxels);
        (clusters, voxels)
    }

    proptest! {
        #[test]
        fn near_points_are_joined_and_far_ones_are_not(
            points in prop::collection::vec((0.0..0.12_f32, 0.0..0.12_f32, 0.0..0.04_f32), 2..60),
        ) {
            let points: Vec<Point> = points.iter().map(|&(x, y, z)| at(x, y, z)).collect();
            let (clusters, _) = joined(&points);
            let cluster = |i: usize| clusters.of_point[i];
            // Points of two clusters are more than a cell apart along some axis.
            for i in 0..points.len() {
                for j in 0..i {
                    let (a, b) = (&points[i], &points[j]);
                    let apart = (a.x - b.x).abs().max((a.y - b.y).abs()).max((a.z - b.z).abs());
                    prop_assert!(cluster(i) == cluster(j) || apart > 0.99 * CELL_M);
                }
            }
            // A cluster has no gap of two cells along any axis.
            for number in 0..clusters.len() {
                let mut xs: Vec<f32> =
                    clusters.members(number).iter().map(|&i| points[i as usize].x).collect();
                xs.sort_by(f32::total_cmp);
                prop_assert!(xs.windows(2).all(|pair| pair[1] - pair[0] <= 2.01 * CELL_M));
            }
        }
    }

    #[test]
    fn split_parts_meet_halfway() {
        let points: Vec<Point> = (0..100).map(|i| at(0.003 * i as f32, 0.0, 0.0)).collect();
        let (mut clusters, voxels) = joined(&points);
        assert_eq!(clusters.len(), 1);
        let part_of: Vec<u32> = (0..100)
            .map(|i| match i {
                10 => 0,
                90 => 1,
                _ => UNLABELLED,
            })
            .collect();
        clusters.split(0, &part_of, 1, &voxels);
        clusters.regroup(2);
        let (low, high) = (clusters.members(0), clusters.members(1));
        assert_eq!(low.len() + high.len(), 100);
        assert!(low.len().abs_diff(high.len()) < 6);
        assert!(low.iter().all(|i| high.iter().all(|j| i < j)));
    }
}
