//! Voxel centroids for the plane search, sorted by coarse cube.

use super::voxel_grid::{REACH_M, VoxelGrid};
use crate::samples::Samples;
use random::Random;

/// Side of the coarse cubes, metres. The points of a hypothesis are drawn from one cube,
/// because neighbours share a surface more often than random points. Chosen.
const CUBE_M: f32 = 0.25;

/// Voxel centroids sorted by cube, each a sample with its assignment to a plane.
#[derive(Debug, Default)]
pub(super) struct VoxelCentroids {
    order: Vec<(u64, u32)>,
    pub(super) samples: Samples,
}

impl VoxelCentroids {
    pub(super) fn refill(&mut self, voxels: &VoxelGrid) {
        let Self { order, samples } = self;
        order.clear();
        order.extend((0..voxels.len()).map(|voxel| {
            let centroid = voxels.centroid(voxel);
            // Coordinates are bounded by the grid's reach, so 10 bits suffice.
            let [i, j, k] = centroid.map(|x| ((x + REACH_M) / CUBE_M) as u64);
            ((k << 10 | j) << 10 | i, voxel as u32)
        }));
        order.sort_unstable();
        samples.refill_column(
            order
                .iter()
                .map(|&(_, voxel)| voxels.centroid(voxel as usize)),
        );
    }

    /// Draw three unassigned centroids of one cube; `None` when the draw missed.
    pub(super) fn draw(&self, random: &mut Random) -> Option<[usize; 3]> {
        let anchor = random.below(self.order.len());
        let cube = self.order.get(anchor)?.0;
        let start = self.order.partition_point(|&(other, _)| other < cube);
        let n = self.order[start..].partition_point(|&(other, _)| other == cube);
        let drawn = [anchor, start + random.below(n), start + random.below(n)];
        drawn
            .iter()
            .all(|&i| self.samples.is_unassigned(i))
            .then_some(drawn)
    }
}
