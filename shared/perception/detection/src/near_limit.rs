//! Near limit of the depth range: objects of which the part nearer than it is missing.
//!
//! A structured-light or time-of-flight camera has no depth below its shortest distance, so
//! that an object there ends in the middle of the image, as at the image border.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use crate::table::Table;
use point_cloud::OrganizedCloud;

/// Greatest depth of a contour that the near limit may cut, as a multiple of the shortest
/// depth of the frame. Chosen.
const DEPTH_RATIO_MAX: f32 = 1.05;

/// Least length of the contour at the near limit, pixels of the image. Chosen.
const CONTOUR_PX_MIN: usize = 16;

/// Distance between the probes for depth beyond a contour, pixels. Chosen.
const PROBE_STEP_PX: f64 = 4.0;

/// Number of pixels within a probe step of a contour of the least length.
const N_PIXELS_MIN: usize = CONTOUR_PX_MIN * PROBE_STEP_PX as usize;

/// Least number of probes without depth before the floor: more than the shadow of an object
/// at the table's rim. Chosen.
const N_PROBES_MIN: usize = 6;

/// Height over the table below which a probe sees past it, metres. Chosen.
const PAST_TABLE_M: f32 = -0.05;

/// Near limit of the depth range in a frame, and the direction in the image in which the
/// table comes nearer.
pub(crate) struct NearLimit<'a> {
    cloud: OrganizedCloud<'a>,
    height: AffineForm,
    depth_max_m: f32,
    step_px: [f64; 2],
}

impl<'a> NearLimit<'a> {
    /// Near limit of a frame with this table. The shortest depth among the samples stands for
    /// the limit of the sensor, which is not nearer.
    pub(crate) fn of(cloud: OrganizedCloud<'a>, samples: &Samples, table: &Table) -> Self {
        let depths_m = (0..samples.len()).map(|sample| samples.depth(sample));
        let has_depth = |depth_m: &f32| *depth_m > 0.0;
        let nearest_m = depths_m.filter(has_depth).fold(f32::INFINITY, f32::min);
        let up = &table.plane.normal;
        let length = up.x.hypot(up.y);
        // Straight down all directions are equal, and none leads nearer.
        let step_px = if length > 1e-3 {
            [up.x, up.y].map(|part| -part / length * PROBE_STEP_PX)
        } else {
            [0.0, PROBE_STEP_PX]
        };
        Self {
            cloud,
            height: AffineForm::from(&table.plane),
            depth_max_m: nearest_m * DEPTH_RATIO_MAX,
            step_px,
        }
    }

    /// `true` when the near limit cuts the object with these pixels: a part of its contour is
    /// at the shortest depth, and from there to the image border, or past the table, nothing
    /// has depth.
    pub(crate) fn cuts(&self, pixels: &[u32]) -> bool {
        let at_limit = pixels
            .iter()
            .filter(|&&pixel| self.is_at_limit(pixel as usize));
        at_limit.take(N_PIXELS_MIN).count() == N_PIXELS_MIN
    }

    /// `true` for a pixel at the shortest depth with nothing beyond it up to the image border
    /// or past the table.
    fn is_at_limit(&self, pixel: usize) -> bool {
        let points = self.cloud.points();
        if points[pixel].z > self.depth_max_m {
            return false;
        }
        let mut beyond = self.probes(pixel).map(|probe| &points[probe]);
        let first = beyond
            .by_ref()
            .enumerate()
            .find(|(_, point)| point.is_finite());
        first.is_none_or(|(n_without_depth, point)| {
            n_without_depth >= N_PROBES_MIN
                && self.height.at(point.x, point.y, point.z) < PAST_TABLE_M
        })
    }

    /// Pixels from this one to the image border, towards the nearer table.
    fn probes(&self, pixel: usize) -> impl Iterator<Item = usize> {
        let [width, height] = [self.cloud.width(), self.cloud.height()];
        let start = [(pixel % width) as f64, (pixel / width) as f64];
        let step = self.step_px;
        (1..).map_while(move |n| {
            let [column, row] =
                [0, 1].map(|axis| (start[axis] + f64::from(n) * step[axis]).round());
            let is_inside =
                column >= 0.0 && row >= 0.0 && column < width as f64 && row < height as f64;
            is_inside.then_some(row as usize * width + column as usize)
        })
    }
}
