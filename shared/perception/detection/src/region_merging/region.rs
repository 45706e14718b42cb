//! Region statistics: colour, area, plane and extent; sums, so that regions can be merged.

use crate::cielab::{CieLab, ColorSum};
use crate::segmentation::Cell;
use nalgebra::{Matrix3, Vector3};
use point_cloud::least_eigenvector;

/// Number of yaws at which the footprint of a region is measured: 15 degrees each.
const N_YAWS: usize = 6;

/// Least side of a region's box, metres: the noise of a flat surface.
const SIDE_MIN_M: f32 = 0.005;

/// Statistics of the pixels of a region.
#[derive(Debug, Clone, Copy)]
pub(super) struct RegionSums {
    color: ColorSum,
    /// Sum of the squares of red, green and blue.
    rgb_squares: u64,
    /// Area as the number of pixels that it would have at 1 m.
    n_pixels_at_1m: f32,
    moments: PointSums,
    extent: Extent,
}

/// Sums of the coordinates in the table's frame and of their products; and of the depth.
#[derive(Debug, Clone, Copy, Default)]
struct PointSums {
    n: f64,
    sum: Vector3<f64>,
    products: Matrix3<f64>,
    depth: f64,
}

/// Extent of points: height range, and range along the axes of each yaw, metres.
#[derive(Debug, Clone, Copy)]
struct Extent {
    height_m: [f32; 2],
    low: [f32; 2 * N_YAWS],
    high: [f32; 2 * N_YAWS],
}

/// Directions of both axes of each yaw in the plane of the table.
#[derive(Debug, Clone)]
pub(super) struct YawAxes([[f32; 2 * N_YAWS]; 2]);

impl Default for YawAxes {
    fn default() -> Self {
        let angle = |i: usize| (i as f32) * std::f32::consts::FRAC_PI_2 / N_YAWS as f32;
        Self([
            std::array::from_fn(|i| angle(i).cos()),
            std::array::from_fn(|i| angle(i).sin()),
        ])
    }
}

impl Default for RegionSums {
    fn default() -> Self {
        Self {
            color: ColorSum::default(),
            rgb_squares: 0,
            n_pixels_at_1m: 0.0,
            moments: PointSums::default(),
            extent: Extent {
                height_m: [f32::INFINITY, f32::NEG_INFINITY],
                low: [f32::INFINITY; 2 * N_YAWS],
                high: [f32::NEG_INFINITY; 2 * N_YAWS],
            },
        }
    }
}

/// Description of a region by which pairs are compared.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Region {
    /// Area as the number of pixels that it would have at 1 m; at least 1.
    pub(super) n_pixels_at_1m: f32,
    pub(super) color: CieLab,
    /// Standard deviation of the colour values, 0 to 255.
    pub(super) color_sigma: f32,
    /// Mean of the points, table's frame, metres.
    pub(super) centroid: Vector3<f32>,
    /// Normal of the fitted plane towards the camera, table's frame.
    pub(super) normal: Vector3<f32>,
    /// Root mean square distance of the points from the fitted plane, metres.
    pub(super) plane_rms_m: f32,
    /// Mean depth, metres.
    pub(super) depth_m: f32,
    /// Least and greatest height over the table, metres.
    pub(super) height_m: [f32; 2],
    /// Sides of the footprint of least area and height of the upright box, metres.
    pub(super) sides_m: [f32; 3],
}

impl RegionSums {
    /// Add a cell with its position in the table's frame, metres.
    #[inline]
    pub(super) fn add(&mut self, cell: &Cell, position: [f32; 3], axes: &YawAxes) {
        self.color.add(cell.rgb);
        let squares = cell.rgb.map(|value| u32::from(value) * u32::from(value));
        self.rgb_squares += u64::from(squares.iter().sum::<u32>());
        self.n_pixels_at_1m += cell.n_pixels as f32 * cell.depth_m * cell.depth_m;
        self.moments.add(position, cell.depth_m);
        self.extent.add(position, axes);
    }

    /// Add the statistics of another region.
    pub(super) fn merge(&mut self, other: &Self) {
        self.color.merge(&other.color);
        self.rgb_squares += other.rgb_squares;
        self.n_pixels_at_1m += other.n_pixels_at_1m;
        self.moments.n += other.moments.n;
        self.moments.sum += other.moments.sum;
        self.moments.products += other.moments.products;
        self.moments.depth += other.moments.depth;
        let (own, other) = (&mut self.extent, &other.extent);
        own.height_m = [
            own.height_m[0].min(other.height_m[0]),
            own.height_m[1].max(other.height_m[1]),
        ];
        for i in 0..2 * N_YAWS {
            own.low[i] = own.low[i].min(other.low[i]);
            own.high[i] = own.high[i].max(other.high[i]);
        }
    }

    /// Description of the region; `camera` is the camera's position in the table's frame.
    pub(super) fn describe(&self, camera: &Vector3<f32>) -> Region {
        let PointSums {
            n,
            sum,
            products,
            depth,
        } = self.moments;
        if n == 0.0 {
            return Region {
                n_pixels_at_1m: 1.0,
                ..Region::default()
            };
        }
        let mean = sum / n;
        let ([variance_m2, ..], normal) =
            least_eigenvector(&(products / n - mean * mean.transpose()));
        let [normal, centroid]: [Vector3<f32>; 2] = [normal.cast(), mean.cast()];
        let is_towards = normal.dot(&(camera - centroid)) >= 0.0;
        Region {
            n_pixels_at_1m: self.n_pixels_at_1m.max(1.0),
            color: self.color.mean(),
            color_sigma: self.color.sigma(self.rgb_squares as f64),
            centroid,
            normal: if is_towards { normal } else { -normal },
            plane_rms_m: variance_m2.max(0.0).sqrt() as f32,
            depth_m: (depth / n) as f32,
            height_m: self.extent.height_m,
            sides_m: self.extent.sides_m(),
        }
    }
}

impl PointSums {
    #[inline]
    fn add(&mut self, position: [f32; 3], depth_m: f32) {
        let place = Vector3::from(position.map(f64::from));
        self.n += 1.0;
        self.sum += place;
        self.products += place * place.transpose();
        self.depth += f64::from(depth_m);
    }
}

impl Extent {
    #[inline]
    fn add(&mut self, [u, v, height]: [f32; 3], axes: &YawAxes) {
        let [lowest, highest] = self.height_m;
        self.height_m = [lowest.min(height), highest.max(height)];
        for i in 0..2 * N_YAWS {
            let along = axes.0[0][i] * u + axes.0[1][i] * v;
            self.low[i] = self.low[i].min(along);
            self.high[i] = self.high[i].max(along);
        }
    }

    /// Sides of the footprint of least area, and the height, metres.
    fn sides_m(&self) -> [f32; 3] {
        let side = |i: usize| (self.high[i] - self.low[i]).max(SIDE_MIN_M);
        let sides = (0..N_YAWS).map(|yaw| [side(yaw), side(yaw + N_YAWS)]);
        let smallest = sides.min_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1])));
        let [a, b] = smallest.unwrap_or([SIDE_MIN_M; 2]);
        let height_m = (self.height_m[1] - self.height_m[0]).max(SIDE_MIN_M);
        [a, b, height_m]
    }
}
