//! Voxel centroids for the plane search, sorted by coarse cube.

use super::voxel_grid::VoxelGrid;
use crate::affine_form::AffineForm;
use nalgebra::Point3;
use point_cloud::Moments;
use random::Random;

/// Side of the coarse cubes, metres. The points of a hypothesis are drawn from one cube,
/// because neighbours share a surface more often than random points. Chosen.
const CUBE_M: f32 = 0.25;

/// Voxel centroids sorted by cube, each with its assignment to a plane.
#[derive(Debug, Default)]
pub(super) struct VoxelCentroids {
    order: Vec<(u64, u32)>,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    is_unassigned: Vec<bool>,
}

impl VoxelCentroids {
    pub(super) fn refill(&mut self, voxels: &VoxelGrid) {
        let Self { order, .. } = self;
        order.clear();
        order.extend((0..voxels.len()).map(|voxel| {
            let centroid = voxels.centroid(voxel);
            // Coordinates are bounded by the grid's reach, so 10 bits suffice.
            let [i, j, k] = centroid.map(|x| ((x + super::voxel_grid::REACH_M) / CUBE_M) as u64);
            ((k << 10 | j) << 10 | i, voxel as u32)
        }));
        order.sort_unstable();
        self.clear();
        for i in 0..self.order.len() {
            let centroid = voxels.centroid(self.order[i].1 as usize);
            self.push(centroid);
        }
    }

    fn clear(&mut self) {
        for values in [&mut self.x, &mut self.y, &mut self.z] {
            values.clear();
        }
        self.is_unassigned.clear();
    }

    fn push(&mut self, [x, y, z]: [f32; 3]) {
        self.x.push(x);
        self.y.push(y);
        self.z.push(z);
        self.is_unassigned.push(true);
    }

    /// Number of voxel centroids.
    pub(super) fn len(&self) -> usize {
        self.x.len()
    }

    /// Number of centroids not assigned to a plane.
    pub(super) fn n_unassigned(&self) -> usize {
        self.is_unassigned.iter().filter(|&&free| free).count()
    }

    /// Clears the cluster assignment of all centroids.
    pub(super) fn reset_assignment(&mut self) {
        self.is_unassigned.fill(true);
    }

    /// Copy about `n_target` unassigned centroids, evenly over space.
    pub(super) fn subsample_into(&self, n_target: usize, out: &mut Self) {
        out.clear();
        let step = (self.n_unassigned() / n_target).max(1);
        for i in (0..self.len())
            .filter(|&i| self.is_unassigned[i])
            .step_by(step)
        {
            out.push([self.x[i], self.y[i], self.z[i]]);
        }
    }

    #[inline]
    pub(super) fn position(&self, i: usize) -> Point3<f64> {
        Point3::new(
            f64::from(self.x[i]),
            f64::from(self.y[i]),
            f64::from(self.z[i]),
        )
    }

    /// Value of an affine form at a centroid, metres.
    #[inline]
    pub(super) fn coordinate(&self, axis: &AffineForm, i: usize) -> f32 {
        axis.at(self.x[i], self.y[i], self.z[i])
    }

    /// Draw three unassigned centroids of one cube; `None` when the draw missed.
    pub(super) fn draw(&self, random: &mut Random) -> Option<[usize; 3]> {
        let anchor = random.below(self.len());
        let cube = self.order.get(anchor)?.0;
        let start = self.order.partition_point(|&(other, _)| other < cube);
        let n = self.order[start..].partition_point(|&(other, _)| other == cube);
        let drawn = [anchor, start + random.below(n), start + random.below(n)];
        drawn
            .iter()
            .all(|&i| self.is_unassigned[i])
            .then_some(drawn)
    }

    /// Number of centroids in a band around a plane, assigned or not.
    pub(super) fn count_in_band(&self, height: &AffineForm, band_m: f32) -> u32 {
        let n = self.len();
        let (x, y, z) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        (0..n)
            .map(|i| u32::from(height.at(x[i], y[i], z[i]).abs() <= band_m))
            .sum()
    }

    /// Moments of the unassigned centroids in a band around a plane.
    pub(super) fn band_moments(&self, height: &AffineForm, band_m: f32) -> Moments {
        let mut moments = Moments::default();
        for i in self.unassigned_in_band(height, band_m) {
            moments.add(&self.position(i));
        }
        moments
    }

    /// Unassigned centroids in a band around a plane.
    pub(super) fn unassigned_in_band<'a>(
        &'a self,
        height: &'a AffineForm,
        band_m: f32,
    ) -> impl Iterator<Item = usize> + 'a {
        (0..self.len())
            .filter(move |&i| self.is_unassigned[i] && self.coordinate(height, i).abs() <= band_m)
    }

    /// Assign the centroids in a band around a plane, which removes them from further
    /// searches.
    pub(super) fn assign_in_band(&mut self, height: &AffineForm, band_m: f32) {
        for i in 0..self.len() {
            if self.coordinate(height, i).abs() <= band_m {
                self.is_unassigned[i] = false;
            }
        }
    }
}
