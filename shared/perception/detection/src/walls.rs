//! Walls: steep planes behind a support surface, which belong to the surroundings.
//!
//! A wall, the back of a shelf, the side of a tote or a partition stands at the border of the
//! surface: no part of the surface is seen behind it, and it goes on where no object of the surface
//! can be, is longer than any object, or spans the whole surface. What lies in such a plane or
//! behind it is no object.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::plane_ransac::{hypothesis_draws, least_squares_plane};
use crate::samples::Samples;
use crate::table::Table;
use crate::table_surface::TableSurface;
use geometry::{Plane, RigidTransform};
use nalgebra::Point3;
use point_cloud::{Moments, OrganizedCloud};
use random::Random;
use sensor_noise::DepthNoise;

/// Least height over the surface of a point of a wall, metres; lower points are the surface.
/// Chosen.
const HEIGHT_MIN_M: f32 = 0.02;

/// Greatest sine of the angle between a wall and the vertical (25 degrees): the sides of totes
/// slant. Chosen.
const SLANT_SIN_MAX: f64 = 0.42;

/// Distance from the border within which a point of a wall stands over the surface, metres.
/// Chosen.
const BORDER_M: f32 = 0.10;

/// Least half width of the band of a wall, metres. Chosen.
const BAND_MIN_M: f32 = 0.015;

/// Half width of the band of a wall in sigmas of the depth noise. Chosen.
const BAND_SIGMAS: f32 = 4.0;

/// Greatest distance of a corner of the surface behind a wall, metres. Chosen.
const BEHIND_MAX_M: f64 = 0.06;

/// Least extent along a wall, metres. Chosen.
const EXTENT_MIN_M: f64 = 0.25;

/// Least extent of a wall that spans the surface, share of the extent of the surface. Chosen.
const SPAN_SHARE_MIN: f64 = 0.8;

/// Least extent of such a wall, metres: many objects are as long as a small surface. Chosen.
const SPAN_MIN_M: f64 = 0.3;

/// Least share of a wall's samples outside of the space of objects, or at the border of the
/// image. Chosen.
const OUTSIDE_SHARE_MIN: f64 = 0.2;

/// Least share of the samples of an image on a wall. Chosen.
const SHARE_MIN: f64 = 0.006;

/// Number of hypotheses for a wall. Chosen.
const N_HYPOTHESES: usize = 64;

/// Greatest number of samples on which a hypothesis is counted. Chosen.
const N_COUNTED: usize = 512;

/// Greatest number of walls.
const N_WALLS_MAX: usize = 4;

/// Walls around a surface, with buffers. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Walls {
    /// Samples that may show a wall.
    pool: Vec<u32>,
    planes: Vec<Plane>,
}

/// Image and surface that are searched for walls.
struct WallSearch<'a> {
    samples: &'a Samples,
    table: &'a Table,
    cells: &'a TableSurface,
    axes: [AffineForm; 3],
    height_max_m: f32,
    /// Greatest side of an object, metres.
    side_max_m: f64,
    n_min: usize,
}

impl Walls {
    /// Find the walls around a surface.
    pub(crate) fn find(
        &mut self,
        samples: &Samples,
        table: &Table,
        cells: &TableSurface,
        config: &RawConfig,
    ) {
        let search = WallSearch {
            samples,
            table,
            cells,
            axes: AffineForm::coordinates_of(&table.table_from_camera),
            height_max_m: config.height_max_m as f32,
            side_max_m: config.side_max_m,
            n_min: (SHARE_MIN * samples.len() as f64) as usize,
        };
        self.planes.clear();
        self.pool.clear();
        let all = 0..samples.len();
        self.pool.extend(
            all.filter(|&one| search.may_be_wall(one))
                .map(|one| one as u32),
        );
        let mut random = hypothesis_draws();
        for _ in 0..N_WALLS_MAX {
            let Some(plane) = search.largest_steep_plane(&self.pool, &mut random) else {
                return;
            };
            if search.is_wall(&plane, &self.pool) {
                self.planes.push(plane);
            }
            let is_in_band = search.band(&plane);
            self.pool.retain(|sample| !is_in_band(&sample));
        }
    }

    /// Remove the pixels in the planes of the walls and behind them.
    pub(crate) fn remove_from(
        &self,
        pixels: &mut Vec<u32>,
        cloud: &OrganizedCloud<'_>,
        noise: &DepthNoise,
    ) {
        for plane in &self.planes {
            let distance = AffineForm::from(plane);
            pixels.retain(|&pixel| {
                let point = &cloud.points()[pixel as usize];
                distance.at(point.x, point.y, point.z) > band_m(point.z, noise)
            });
        }
    }
}

/// Half width of the band of a wall at a depth, metres.
fn band_m(depth_m: f32, noise: &DepthNoise) -> f32 {
    BAND_MIN_M.max(BAND_SIGMAS * noise.sigma_m(depth_m))
}

impl WallSearch<'_> {
    fn coordinates(&self, sample: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.samples.coordinate(&self.axes[axis], sample))
    }

    /// `true` for a sample over the height of the surface that is not well inside its border.
    fn may_be_wall(&self, sample: usize) -> bool {
        if self.samples.depth(sample) <= 0.0 {
            return false;
        }
        let [u, v, height_m] = self.coordinates(sample);
        let is_table = |du: f32, dv: f32| self.cells.is_table(u + du, v + dv);
        let is_inside = || {
            is_table(-BORDER_M, 0.0)
                && is_table(BORDER_M, 0.0)
                && is_table(0.0, -BORDER_M)
                && is_table(0.0, BORDER_M)
        };
        height_m >= HEIGHT_MIN_M && !is_inside()
    }

    /// `true` for the samples in the band of a plane.
    fn band<'b>(&'b self, plane: &Plane) -> impl Fn(&&u32) -> bool + 'b {
        let distance = AffineForm::from(plane);
        move |&&sample| {
            let sample = sample as usize;
            let distance_m = self.samples.coordinate(&distance, sample).abs();
            distance_m <= band_m(self.samples.depth(sample), &self.table.depth_noise)
        }
    }

    /// Steep plane with the most samples, facing the camera (RANSAC, Fischler and Bolles 1981);
    /// `None` when it has too few.
    fn largest_steep_plane(&self, pool: &[u32], random: &mut Random) -> Option<Plane> {
        if pool.len() < self.n_min.max(3) {
            return None;
        }
        let step = pool.len().div_ceil(N_COUNTED);
        let counted = || pool.iter().step_by(step);
        let mut best = (0, None);
        for _ in 0..N_HYPOTHESES {
            let [a, b, c] = [0; 3].map(|_| {
                let drawn = pool[random.below(pool.len())];
                self.samples.position(drawn as usize)
            });
            let Some(plane) = Plane::through_points(&a, &b, &c).filter(|one| self.is_steep(one))
            else {
                continue;
            };
            let n = counted().filter(self.band(&plane)).count();
            if n > best.0 {
                best = (n, Some(plane));
            }
        }
        let mut moments = Moments::default();
        let plane = best.1?;
        for &sample in pool.iter().filter(self.band(&plane)) {
            moments.add(&self.samples.position(sample as usize));
        }
        let plane = least_squares_plane(&moments.principal_axes()?)?.facing(&Point3::origin());
        let n = pool.iter().filter(self.band(&plane)).count();
        (n >= self.n_min && self.is_steep(&plane)).then_some(plane)
    }

    fn is_steep(&self, plane: &Plane) -> bool {
        plane.normal.dot(&self.table.plane.normal).abs() <= SLANT_SIN_MAX
    }

    /// `true` when the surface lies in front of a steep plane, and the plane goes on outside of the
    /// space of objects or spans the surface.
    fn is_wall(&self, plane: &Plane, pool: &[u32]) -> bool {
        let along = self.table.plane.normal.cross(&plane.normal);
        let (mut surface, mut seen) = (Interval::EMPTY, Interval::EMPTY);
        let mut is_in_front = true;
        for corner in self.table.corners(&RigidTransform::identity()) {
            is_in_front &= plane.height_m(&corner) >= -BEHIND_MAX_M;
            surface.add(along.dot(&corner.coords));
        }
        let (mut n, mut n_outside) = (0_usize, 0_usize);
        for &sample in pool.iter().filter(self.band(plane)) {
            n += 1;
            n_outside += usize::from(self.is_outside(sample as usize));
            seen.add(along.dot(&self.samples.position(sample as usize).coords));
        }
        let goes_on = n_outside as f64 >= OUTSIDE_SHARE_MIN * n as f64;
        let spans =
            seen.length() >= SPAN_MIN_M && seen.length() >= SPAN_SHARE_MIN * surface.length();
        let is_too_long = seen.length() > self.side_max_m;
        is_in_front && (spans || is_too_long || goes_on && seen.length() >= EXTENT_MIN_M)
    }

    /// `true` when a sample is outside of the space of objects, or at the border of the image.
    fn is_outside(&self, sample: usize) -> bool {
        let [u, v, height_m] = self.coordinates(sample);
        let (width, height) = (self.samples.width(), self.samples.height());
        let [column, row] = [sample % width, sample / width];
        let is_at_border = column <= 1 || row <= 1 || column + 2 >= width || row + 2 >= height;
        is_at_border || height_m > self.height_max_m || !self.cells.is_near(u, v)
    }
}

/// Closed interval of a coordinate.
#[derive(Debug, Clone, Copy)]
struct Interval([f64; 2]);

impl Interval {
    const EMPTY: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    fn add(&mut self, value: f64) {
        self.0 = [self.0[0].min(value), self.0[1].max(value)];
    }

    fn length(&self) -> f64 {
        (self.0[1] - self.0[0]).max(0.0)
    }
}
