//! Walls: steep planes behind a support surface, which belong to the surroundings.
//!
//! A wall, the back of a shelf, the side of a tote or a partition stands at the border of the
//! surface: no part of the surface is seen behind it, and it goes on where no object of the surface
//! can be, beneath the surface as well, is longer than any object, or spans the whole surface.
//! Such a plane, and everything behind it, is no object.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::pixel_bounds::PixelBounds;
use crate::plane_ransac::{hypothesis_draws, least_squares_plane};
use crate::samples::Samples;
use crate::table::Table;
use crate::table_surface::TableSurface;
use geometry::{Plane, RigidTransform};
use nalgebra::{Point3, Vector3};
use point_cloud::{Moments, OrganizedCloud};
use random::Random;
use sensor_noise::DepthNoise;

/// Least height over the surface of a point of a wall, metres; lower points are the surface.
/// Chosen.
const HEIGHT_MIN_M: f32 = 0.02;

/// Greatest sine of the angle between a wall and the vertical (25 degrees): the sides of totes
/// slant. Chosen.
const SLANT_SIN_MAX: f64 = 0.42;

/// Least depth beneath the surface of a sample of a wall that goes on there, metres: the edge of a
/// board is thinner. Chosen.
const BENEATH_MIN_M: f32 = 0.05;

/// Greatest cosine of the angle between the vertical and the normal of the image around a sample of
/// a wall: the normals of neighbouring samples are noisy. Chosen.
const FLAT_COS_MAX: f64 = 0.7;

/// Distance from the border within which a point of a wall stands over the surface, metres.
/// Chosen.
const BORDER_M: f32 = 0.10;

/// Least half width of the band of a wall, metres. Chosen.
const BAND_MIN_M: f32 = 0.015;

/// Half width of the band of a wall in sigmas of the depth noise. Chosen.
const BAND_SIGMAS: f32 = 4.0;

/// Greatest distance of a corner of the surface behind a wall, metres. Chosen.
const BEHIND_MAX_M: f64 = 0.06;

/// The same for a hypothesis of three noisy samples, metres. Chosen.
const HYPOTHESIS_BEHIND_MAX_M: f64 = 0.3;

/// Least extent along a wall, metres. Chosen.
const EXTENT_MIN_M: f64 = 0.25;

/// Least extent along a wall that goes on beneath the surface, metres: nothing that stands on the
/// surface does. Chosen.
const EXTENT_BENEATH_MIN_M: f64 = 0.12;

/// Number of parts of the extent of a wall, most of which it fills. Chosen.
const N_PARTS: usize = 16;

/// Least number of parts with samples: two objects in one plane are no wall. Chosen.
const N_PARTS_FILLED_MIN: usize = 11;

/// Least extent of a wall that spans the surface, share of the extent of the surface. Chosen.
const SPAN_SHARE_MIN: f64 = 0.8;

/// Least extent of such a wall, metres: many objects are as long as a small surface. Chosen.
const SPAN_MIN_M: f64 = 0.3;

/// Least share of a wall's samples outside of the space of objects, or at the border of the
/// image. Chosen.
const OUTSIDE_SHARE_MIN: f64 = 0.2;

/// Greatest distance from the border of a sample at it, samples. Chosen.
const BORDER_SAMPLES: usize = 1;

/// Least share of the samples of an image on a wall. Chosen.
const SHARE_MIN: f64 = 0.006;

/// Number of hypotheses for a wall by samples from anywhere, which fit a large one well. Chosen.
const N_HYPOTHESES: usize = 64;

/// Number of hypotheses by neighbouring samples, which find a small one. Chosen.
const N_LOCAL_HYPOTHESES: usize = 64;

/// Number of fits of a hypothesis to its samples, which each finds more of a wall. Chosen.
const N_FITS: usize = 3;

/// Distance between neighbouring samples of a hypothesis, samples of the image. Chosen: several
/// centimetres at a metre.
const NEIGHBOUR_STEP: usize = 6;

/// Greatest difference in depth between neighbouring samples of a hypothesis, metres. Chosen.
const NEIGHBOUR_DEPTH_MAX_M: f32 = 0.15;

/// Greatest number of samples on which a hypothesis is counted. Chosen.
const N_COUNTED: usize = 512;

/// Greatest number of walls.
const N_WALLS_MAX: usize = 6;

/// Sample that may show a wall.
#[derive(Debug, Clone, Copy)]
struct WallSample {
    sample: u32,
    position: [f32; 3],
    /// Half width of the band of a wall at its depth, metres.
    band_m: f32,
}

impl WallSample {
    fn is_on(&self, plane: &AffineForm) -> bool {
        let [x, y, z] = self.position;
        plane.at(x, y, z).abs() <= self.band_m
    }

    fn point(&self) -> Point3<f64> {
        Point3::from(self.position.map(f64::from))
    }
}

/// Walls around a surface, with buffers. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Walls {
    pool: Vec<WallSample>,
    planes: Vec<Plane>,
}

/// Image and surface that are searched for walls.
struct WallSearch<'a> {
    samples: &'a Samples,
    table: &'a Table,
    cells: &'a TableSurface,
    axes: [AffineForm; 3],
    config: &'a RawConfig,
    n_min: usize,
    /// Columns and rows of samples with depth: registered depth leaves empty margins.
    bounds: PixelBounds,
}

impl Walls {
    /// Find the walls around a surface, and add them to those of the surfaces before, of which each
    /// that is behind this one is a wall here, too.
    pub(crate) fn find(
        &mut self,
        samples: &Samples,
        (table, cells): (&Table, &TableSurface),
        config: &RawConfig,
        of_others: &mut Vec<Plane>,
    ) {
        let search = WallSearch {
            samples,
            table,
            cells,
            axes: AffineForm::coordinates_of(&table.table_from_camera),
            config,
            n_min: ((SHARE_MIN * samples.len() as f64) as usize).max(3),
            bounds: bounds_of_depth(samples),
        };
        self.planes.clear();
        self.pool.clear();
        let all = 0..samples.len();
        self.pool
            .extend(all.filter_map(|one| search.wall_sample(one)));
        for plane in of_others.iter() {
            if search.is_behind(plane, BEHIND_MAX_M) {
                self.planes.push(*plane);
                let plane = AffineForm::from(plane);
                self.pool.retain(|one| !one.is_on(&plane));
            }
        }
        let mut random = hypothesis_draws();
        for _ in 0..N_WALLS_MAX {
            let Some(plane) = search.largest_plane_behind(&self.pool, &mut random) else {
                return;
            };
            if search.is_wall(&plane, &self.pool) {
                self.planes.push(plane);
                of_others.push(plane);
            }
            let plane = AffineForm::from(&plane);
            self.pool.retain(|one| !one.is_on(&plane));
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

/// Bounding rectangle of the samples with depth.
fn bounds_of_depth(samples: &Samples) -> PixelBounds {
    let mut bounds = PixelBounds::default();
    for sample in (0..samples.len()).filter(|&sample| samples.depth(sample) > 0.0) {
        bounds.add(sample % samples.width(), sample / samples.width());
    }
    bounds
}

/// Half width of the band of a wall at a depth, metres.
fn band_m(depth_m: f32, noise: &DepthNoise) -> f32 {
    BAND_MIN_M.max(BAND_SIGMAS * noise.sigma_m(depth_m))
}

impl WallSearch<'_> {
    /// Sample over the height of the surface that is not well inside its border, nor on something
    /// level.
    fn wall_sample(&self, sample: usize) -> Option<WallSample> {
        let depth_m = self.samples.depth(sample);
        let [u, v, height] = &self.axes;
        if depth_m <= 0.0 || self.samples.coordinate(height, sample) < HEIGHT_MIN_M {
            return None;
        }
        let [u, v] = [u, v].map(|axis| self.samples.coordinate(axis, sample));
        let around = [
            [-BORDER_M, 0.0],
            [BORDER_M, 0.0],
            [0.0, -BORDER_M],
            [0.0, BORDER_M],
        ];
        let is_inside = |[du, dv]: [f32; 2]| self.cells.is_table(u + du, v + dv);
        let up = &self.table.plane.normal;
        let is_level = || {
            let around = self.plane_at(sample);
            around.is_some_and(|plane| plane.normal.dot(up).abs() > FLAT_COS_MAX)
        };
        let may_be_wall = !around.into_iter().all(is_inside) && !is_level();
        may_be_wall.then(|| WallSample {
            sample: sample as u32,
            position: self.samples.position(sample).cast().into(),
            band_m: band_m(depth_m, &self.table.depth_noise),
        })
    }

    /// Steep plane with the most samples, facing the camera and about behind the surface (RANSAC,
    /// Fischler and Bolles 1981); `None` when it has too few.
    fn largest_plane_behind(&self, pool: &[WallSample], random: &mut Random) -> Option<Plane> {
        if pool.len() < self.n_min {
            return None;
        }
        let counted = pool.iter().step_by(pool.len().div_ceil(N_COUNTED));
        let mut best: (usize, Option<Plane>) = (0, None);
        for number in 0..N_HYPOTHESES + N_LOCAL_HYPOTHESES {
            let plane = if number < N_HYPOTHESES {
                let [a, b, c] = [0; 3].map(|_| pool[random.below(pool.len())].point());
                Plane::through_points(&a, &b, &c)
            } else {
                self.plane_at(pool[random.below(pool.len())].sample as usize)
            };
            let plane = plane.map(|plane| plane.facing(&Point3::origin()));
            let Some(plane) = plane.filter(|one| self.is_behind(one, HYPOTHESIS_BEHIND_MAX_M))
            else {
                continue;
            };
            let form = AffineForm::from(&plane);
            let n = counted.clone().filter(|one| one.is_on(&form)).count();
            if n > best.0 {
                best = (n, Some(plane));
            }
        }
        let mut plane = best.1?;
        for _ in 0..N_FITS {
            let form = AffineForm::from(&plane);
            let mut moments = Moments::default();
            for one in pool.iter().filter(|one| one.is_on(&form)) {
                moments.add(&one.point());
            }
            plane = least_squares_plane(&moments.principal_axes()?)?.facing(&Point3::origin());
        }
        let form = AffineForm::from(&plane);
        let n = pool.iter().filter(|one| one.is_on(&form)).count();
        (n >= self.n_min).then_some(plane)
    }

    /// Plane through a sample and its neighbours in the image, below and to the right; `None`
    /// across a step in depth.
    fn plane_at(&self, sample: usize) -> Option<Plane> {
        let width = self.samples.width();
        let right = sample + NEIGHBOUR_STEP;
        let below = sample + NEIGHBOUR_STEP * width;
        if right / width != sample / width || below >= self.samples.len() {
            return None;
        }
        let depth_m = self.samples.depth(sample);
        let is_near = |other: usize| {
            let step_m = self.samples.depth(other) - depth_m;
            self.samples.depth(other) > 0.0 && step_m.abs() <= NEIGHBOUR_DEPTH_MAX_M
        };
        let [a, b, c] = [sample, right, below].map(|one| self.samples.position(one));
        (is_near(right) && is_near(below))
            .then(|| Plane::through_points(&a, &b, &c))
            .flatten()
    }

    /// `true` for a steep plane that faces the camera and has all corners of the surface at most a
    /// distance behind it.
    fn is_behind(&self, plane: &Plane, behind_max_m: f64) -> bool {
        let is_steep = plane.normal.dot(&self.table.plane.normal).abs() <= SLANT_SIN_MAX;
        let in_camera = RigidTransform::identity();
        let mut corners = self.table.corners(&in_camera);
        is_steep && corners.all(|corner| plane.height_m(&corner) >= -behind_max_m)
    }

    /// `true` when a plane is steep and behind the surface, and goes on outside of the space of
    /// objects, is longer than any object, or spans the surface.
    fn is_wall(&self, plane: &Plane, pool: &[WallSample]) -> bool {
        let along = self.table.plane.normal.cross(&plane.normal);
        let (mut surface, mut seen) = (Interval::EMPTY, Interval::EMPTY);
        for corner in self.table.corners(&RigidTransform::identity()) {
            surface.add(along.dot(&corner.coords));
        }
        let form = AffineForm::from(plane);
        let (mut n, mut n_outside) = (0_usize, 0_usize);
        for one in pool.iter().filter(|one| one.is_on(&form)) {
            n += 1;
            n_outside += usize::from(self.is_outside(one.sample as usize));
            seen.add(along.dot(&one.point().coords));
        }
        let (n_beneath, n_filled) = self.follow(&form, &along, &seen);
        let is_share = |part: usize| part as f64 >= OUTSIDE_SHARE_MIN * n as f64;
        let length_m = seen.length();
        let spans = length_m >= SPAN_MIN_M && length_m >= SPAN_SHARE_MIN * surface.length();
        let is_large = spans
            || length_m > self.config.side_max_m
            || is_share(n_outside) && length_m >= EXTENT_MIN_M
            || is_share(n_beneath) && length_m >= EXTENT_BENEATH_MIN_M;
        is_large && n_filled >= N_PARTS_FILLED_MIN && self.is_behind(plane, BEHIND_MAX_M)
    }

    /// Follows a plane along an interval: the number of its samples beneath the surface, and that
    /// of the parts of the interval that it fills over the surface.
    fn follow(&self, plane: &AffineForm, along: &Vector3<f64>, seen: &Interval) -> (usize, usize) {
        let (mut n_beneath, mut filled) = (0, [false; N_PARTS]);
        for sample in 0..self.samples.len() {
            let depth_m = self.samples.depth(sample);
            let distance_m = self.samples.coordinate(plane, sample).abs();
            if depth_m <= 0.0 || distance_m > band_m(depth_m, &self.table.depth_noise) {
                continue;
            }
            let share = seen.share(along.dot(&self.samples.position(sample).coords));
            let height_m = self.samples.coordinate(&self.axes[2], sample);
            if !(0.0..=1.0).contains(&share) {
                continue;
            }
            n_beneath += usize::from(height_m < -BENEATH_MIN_M);
            if height_m >= HEIGHT_MIN_M {
                filled[((share * N_PARTS as f64) as usize).min(N_PARTS - 1)] = true;
            }
        }
        (n_beneath, filled.into_iter().filter(|&part| part).count())
    }

    /// `true` when a sample is outside of the space of objects, or at the border of the image with
    /// depth.
    fn is_outside(&self, sample: usize) -> bool {
        let [u, v, height_m] = [0, 1, 2].map(|i| self.samples.coordinate(&self.axes[i], sample));
        let mut place = PixelBounds::default();
        place.add(sample % self.samples.width(), sample / self.samples.width());
        self.bounds.is_touched_by(&place, BORDER_SAMPLES)
            || height_m > self.config.height_max_m as f32
            || !self.cells.is_near(u, v)
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

    /// Place of a value in the interval: 0 at its start, 1 at its end.
    fn share(&self, value: f64) -> f64 {
        (value - self.0[0]) / self.length().max(1e-9)
    }

    fn length(&self) -> f64 {
        (self.0[1] - self.0[0]).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::{Point, Rgba};

    #[test]
    fn border_of_the_image_is_that_of_its_depth() {
        let (width, height) = (64, 48);
        let point = |i: usize| {
            let (column, row) = (i % width, i / width);
            if (8..48).contains(&column) && (12..48).contains(&row) {
                let [x, y] = [column, row].map(|at| 0.01 * at as f32);
                let color = Rgba::default();
                Point {
                    x,
                    y,
                    z: 1.0,
                    color,
                }
            } else {
                Point::without_depth(Rgba::default())
            }
        };
        let points: Vec<Point> = (0..width * height).map(point).collect();
        let cloud = OrganizedCloud::new(&points, width, height).unwrap();
        let mut samples = Samples::default();
        samples.refill(&cloud, &RawConfig::default());
        let stride = samples.stride();
        let bounds = bounds_of_depth(&samples);
        assert_eq!(bounds.columns, [8 / stride, 48 / stride - 1]);
        assert_eq!(bounds.rows, [12 / stride, 48 / stride - 1]);
    }
}
