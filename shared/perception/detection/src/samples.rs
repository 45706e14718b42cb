//! Subsampled image on which planes are searched.

mod ray_grid;

use crate::RawConfig;
use crate::affine_form::AffineForm;
use nalgebra::Point3;
use point_cloud::{Moments, OrganizedCloud, Point};
pub(crate) use ray_grid::RayGrid;

/// Target number of samples of an image.
const N_SAMPLES_TARGET: usize = 20_000;

/// Number of samples tested together in one vectorised block.
const BLOCK: usize = 64;

/// Greatest tangent of a viewing ray; a view wider than 150 degrees is a damaged point.
const TANGENT_MAX: f32 = 3.8;

/// Greatest plausible depth, metres; farther points are damaged.
const DEPTH_LIMIT_M: f32 = 20.0;

/// Inlier band of a sample without a plane or out of range; no distance is this small.
const NO_BAND: f32 = -1.0;

/// Subsampled image: coordinates and inlier bands of the samples, row by row. A sample out
/// of range has a negative band.
#[derive(Debug, Default)]
pub(crate) struct Samples {
    stride: usize,
    width: usize,
    height: usize,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    band: Vec<f32>,
    rays: RayGrid,
}

/// Greatest lateral offset from the optical axis, metres.
#[inline]
pub(crate) fn sideways_max_m(z_max: f32) -> f32 {
    TANGENT_MAX * z_max
}

/// Range test of a point: depth in range and lateral offset plausible. `false` for values
/// that are not finite.
#[inline]
#[expect(
    clippy::needless_bitwise_bool,
    reason = "unpredictable branches cost more than comparisons"
)]
pub(crate) fn is_in_range(point: &Point, z_min: f32, z_max: f32) -> bool {
    let side_max = sideways_max_m(z_max);
    (point.z >= z_min)
        & (point.z <= z_max)
        & (point.x.abs() <= side_max)
        & (point.y.abs() <= side_max)
}

impl Samples {
    /// Subsample a cloud: the middle pixel of every `stride x stride` block.
    pub(crate) fn refill(&mut self, cloud: &OrganizedCloud<'_>, config: &RawConfig) {
        let stride = stride_for(cloud);
        self.clear();
        self.stride = stride;
        self.width = (cloud.width() - stride / 2).div_ceil(stride);
        for row in (stride / 2..cloud.height()).step_by(stride) {
            self.height += 1;
            for point in cloud.row(row)[stride / 2..].iter().step_by(stride) {
                self.push(point, config);
            }
        }
        self.rays = RayGrid::fit(self);
    }

    /// Replace the samples by points in one column, all of them assigned until
    /// [`release`](Self::release).
    pub(crate) fn refill_column(&mut self, points: impl Iterator<Item = [f32; 3]>) {
        self.clear();
        for [x, y, z] in points {
            self.x.push(x);
            self.y.push(y);
            self.z.push(z);
        }
        (self.width, self.height) = (1, self.x.len());
        self.release(NO_BAND);
    }

    /// Clear the assignment of all samples and set their inlier band, metres.
    pub(crate) fn release(&mut self, band_m: f32) {
        self.band.clear();
        self.band.resize(self.x.len(), band_m);
    }

    fn clear(&mut self) {
        (self.width, self.height) = (0, 0);
        for values in [&mut self.x, &mut self.y, &mut self.z, &mut self.band] {
            values.clear();
        }
    }

    #[inline]
    fn push(&mut self, point: &Point, config: &RawConfig) {
        let range_max_m = config.range_max_m as f32;
        let usable = is_in_range(point, config.range_min_m as f32, range_max_m);
        // A point beyond the range still tells that its ray passes the plane.
        let [x, y, z] = if usable || is_in_range(point, range_max_m, DEPTH_LIMIT_M) {
            [point.x, point.y, point.z]
        } else {
            [0.0; 3]
        };
        self.x.push(x);
        self.y.push(y);
        self.z.push(z);
        self.band.push(if usable {
            plane_band_m(z, config)
        } else {
            NO_BAND
        });
    }

    /// Depth of a sample, metres; 0 for a sample nearer than the range or without depth. A
    /// sample beyond the range keeps its depth but supports no plane.
    pub(crate) fn depth(&self, sample: usize) -> f32 {
        self.z[sample]
    }

    /// Stride: pixels between samples.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Rays of the samples.
    pub(crate) fn rays(&self) -> &RayGrid {
        &self.rays
    }

    /// Index of a sample's pixel in an image of a width in pixels.
    pub(crate) fn pixel(&self, sample: usize, width_px: usize) -> usize {
        let middle = self.stride / 2;
        let [row, column] = [sample / self.width, sample % self.width];
        (row * self.stride + middle) * width_px + column * self.stride + middle
    }

    /// Number of columns of the subsampled image.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Number of rows of the subsampled image.
    pub(crate) fn height(&self) -> usize {
        self.height
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.band.len()
    }

    /// `true` when a sample is in range and not assigned to a plane.
    #[inline]
    pub(crate) fn is_unassigned(&self, sample: usize) -> bool {
        self.band[sample] >= 0.0
    }

    /// Number of samples in range that are not assigned to a plane.
    pub(crate) fn n_unassigned(&self) -> usize {
        self.band.iter().filter(|&&band| band >= 0.0).count()
    }

    /// Coordinates of the samples, camera frame, and whether they are in range and not assigned
    /// to a plane.
    pub(crate) fn points(&self) -> impl Iterator<Item = ([f32; 3], bool)> {
        let coordinates = self.x.iter().zip(&self.y).zip(&self.z);
        let points = coordinates.map(|((&x, &y), &z)| [x, y, z]);
        points.zip(self.band.iter().map(|&band| band >= 0.0))
    }

    /// Position of a sampled point, camera frame.
    #[inline]
    pub(crate) fn position(&self, sample: usize) -> Point3<f64> {
        let as_f64 = |values: &[f32]| f64::from(values[sample]);
        Point3::new(as_f64(&self.x), as_f64(&self.y), as_f64(&self.z))
    }

    /// Visit the inliers of a plane with their coordinates, camera frame, in the order of the
    /// image. The distances are computed block by block, so that the compiler vectorises them.
    #[inline]
    pub(crate) fn visit_inliers(&self, plane: &AffineForm, mut visit: impl FnMut(usize, [f32; 3])) {
        let n = self.len();
        let (x, y, z, band) = (&self.x[..n], &self.y[..n], &self.z[..n], &self.band[..n]);
        let mut distance_m = [0.0; BLOCK];
        for first in (0..n).step_by(BLOCK) {
            let block = first..n.min(first + BLOCK);
            let [x, y, z, band] = [x, y, z, band].map(|values| &values[block.clone()]);
            for (distance_m, ((x, y), z)) in distance_m.iter_mut().zip(x.iter().zip(y).zip(z)) {
                *distance_m = plane.at(*x, *y, *z).abs();
            }
            for (i, (distance_m, band)) in distance_m.iter().zip(band).enumerate() {
                if distance_m <= band {
                    visit(first + i, [x[i], y[i], z[i]]);
                }
            }
        }
    }

    /// Number of samples that are inliers of a plane.
    pub(crate) fn count_inliers(&self, plane: &AffineForm) -> u32 {
        let n = self.len();
        let (x, y, z, band) = (&self.x[..n], &self.y[..n], &self.z[..n], &self.band[..n]);
        (0..n)
            .map(|i| u32::from(plane.at(x[i], y[i], z[i]).abs() <= band[i]))
            .sum()
    }

    /// Moments of the inliers of a plane.
    pub(crate) fn inlier_moments(&self, plane: &AffineForm) -> Moments {
        let mut moments = Moments::default();
        self.visit_inliers(plane, |_, position| {
            moments.add(&Point3::from(position.map(f64::from)));
        });
        moments
    }

    /// Copy every `step`-th unassigned sample, without the grid.
    pub(crate) fn subsample_into(&self, step: usize, out: &mut Self) {
        out.clear();
        let mut n_seen = 0;
        for sample in 0..self.len() {
            if self.is_unassigned(sample) {
                if n_seen % step == 0 {
                    out.x.push(self.x[sample]);
                    out.y.push(self.y[sample]);
                    out.z.push(self.z[sample]);
                    out.band.push(self.band[sample]);
                }
                n_seen += 1;
            }
        }
    }

    /// Assign the inliers of a plane, which removes them from further searches.
    pub(crate) fn assign_inliers(&mut self, plane: &AffineForm) {
        let n = self.len();
        let (x, y, z, band) = (
            &self.x[..n],
            &self.y[..n],
            &self.z[..n],
            &mut self.band[..n],
        );
        for i in 0..n {
            let is_inlier = plane.at(x[i], y[i], z[i]).abs() <= band[i];
            band[i] = if is_inlier { NO_BAND } else { band[i] };
        }
    }

    /// Clears the assignment of all samples in range.
    pub(crate) fn reset_assignment(&mut self, config: &RawConfig) {
        for (band, &z) in self.band.iter_mut().zip(&self.z) {
            *band = if z > 0.0 && z <= config.range_max_m as f32 {
                plane_band_m(z, config)
            } else {
                NO_BAND
            };
        }
    }

    /// Value of an affine form at a sample, metres.
    #[inline]
    pub(crate) fn coordinate(&self, axis: &AffineForm, sample: usize) -> f32 {
        axis.at(self.x[sample], self.y[sample], self.z[sample])
    }
}

/// Half width of a plane's inlier band at a depth, metres: three sigma of the depth noise
/// or the configured least width.
#[inline]
pub(crate) fn plane_band_m(z: f32, config: &RawConfig) -> f32 {
    (3.0 * config.depth_noise.sigma_m(z)).max(config.plane_band_min_m as f32)
}

/// Subsampling stride of a cloud, at most its shorter side, so that at least one sample
/// remains.
fn stride_for(cloud: &OrganizedCloud<'_>) -> usize {
    let thinning = (cloud.points().len() as f64 / N_SAMPLES_TARGET as f64).sqrt();
    (thinning.round() as usize).clamp(1, cloud.width().min(cloud.height()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    #[test]
    fn an_image_is_thinned_to_the_middle_of_its_blocks() {
        let points: Vec<Point> = (0..640 * 480)
            .map(|i| Point {
                x: (i % 640) as f32 * 1e-3,
                y: (i / 640) as f32 * 1e-3,
                z: 1.0,
                color: Rgba::default(),
            })
            .collect();
        let mut samples = Samples::default();
        samples.refill(
            &OrganizedCloud::new(&points, 640, 480).unwrap(),
            &RawConfig::default(),
        );
        assert_eq!(
            (samples.width(), samples.height(), samples.len()),
            (160, 120, 19_200)
        );
        assert!((samples.position(161) - Point3::new(0.006, 0.006, 1.0)).norm() < 1e-6);
    }

    #[test]
    fn only_points_in_range_take_part() {
        let value = |x: f32, z: f32| Point {
            x,
            y: 0.0,
            z,
            color: Rgba::default(),
        };
        let points = [
            value(0.0, f32::NAN),
            value(f32::INFINITY, 1.0),
            value(1e30, 1.0),
            value(0.0, 0.0),
            value(0.0, 1.0),
            value(f32::NAN, 1.0),
        ];
        let mut samples = Samples::default();
        samples.refill(
            &OrganizedCloud::new(&points, 3, 2).unwrap(),
            &RawConfig::default(),
        );
        let free: Vec<usize> = (0..samples.len())
            .filter(|&i| samples.is_unassigned(i))
            .collect();
        assert_eq!(free, [4]);
    }
}
