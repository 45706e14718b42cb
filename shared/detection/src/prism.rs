//! The points over the table.

use crate::RawConfig;
use crate::axis::Axis;
use crate::samples::is_in_range;
use crate::sensor_noise::depth_sigma_m;
use crate::table_plane::Table;
use crate::table_slabs::TableSlabs;
use point_cloud::{OrganizedCloud, Point};

/// What lies over the table must be higher than this many sigma of the height
/// noise.
const NOISE_SIGMAS: f32 = 3.0;

/// How far outside the polygon a point may lie, metres: the seen table ends
/// half a sample before its rim.
const POLYGON_MARGIN_M: f64 = 0.01;

/// The part of the image in which the sensor measures at all: registered depth
/// leaves empty margins, which are the real border of the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SeenRectangle {
    pub(crate) columns: [usize; 2],
    pub(crate) rows: [usize; 2],
}

impl SeenRectangle {
    const NOTHING: Self = Self {
        columns: [usize::MAX, 0],
        rows: [usize::MAX, 0],
    };

    #[inline]
    pub(crate) fn add(&mut self, column: usize, row: usize) {
        self.columns = [self.columns[0].min(column), self.columns[1].max(column)];
        self.rows = [self.rows[0].min(row), self.rows[1].max(row)];
    }

    /// Whether another rectangle within this one comes within `margin_px` of
    /// its border.
    pub(crate) fn is_reached_by(&self, inner: &Self, margin_px: usize) -> bool {
        let near = |outer: [usize; 2], inner: [usize; 2]| {
            inner[0] <= outer[0] + margin_px || inner[1] + margin_px >= outer[1]
        };
        near(self.columns, inner.columns) || near(self.rows, inner.rows)
    }
}

impl Default for SeenRectangle {
    fn default() -> Self {
        Self::NOTHING
    }
}

/// The prism as the inner loop needs it.
pub(crate) struct Prism<'a> {
    z_range: [f32; 2],
    height_range: [f32; 2],
    height: Axis,
    u: Axis,
    v: Axis,
    slabs: &'a TableSlabs,
}

impl<'a> Prism<'a> {
    /// The prism over a table; `slabs` are overwritten.
    pub(crate) fn over(table: &Table, config: &RawConfig, slabs: &'a mut TableSlabs) -> Self {
        slabs.refill(&table.polygon, POLYGON_MARGIN_M);
        let [u, v, height] = Axis::of_transform(&table.table_from_camera);
        Self {
            z_range: [config.range_min_m as f32, config.range_max_m as f32],
            height_range: [config.height_min_m as f32, config.height_max_m as f32],
            height,
            u,
            v,
            slabs,
        }
    }

    /// Whether a point lies in the prism.
    #[inline]
    fn contains(&self, point: &Point) -> bool {
        if !is_in_range(point, self.z_range[0], self.z_range[1]) {
            return false;
        }
        let height = self.height.at(point.x, point.y, point.z);
        let lowest = self.height_range[0].max(NOISE_SIGMAS * depth_sigma_m(point.z));
        (lowest..=self.height_range[1]).contains(&height)
            && self.slabs.contains(
                self.u.at(point.x, point.y, point.z),
                self.v.at(point.x, point.y, point.z),
            )
    }

    /// Lists the pixels in the prism, in image order; returns the part of the
    /// image in which there is any depth.
    pub(crate) fn list(&self, cloud: &OrganizedCloud<'_>, pixels: &mut Vec<u32>) -> SeenRectangle {
        let mut seen = SeenRectangle::default();
        pixels.clear();
        for row in 0..cloud.height() {
            let points = cloud.row(row);
            if let Some(first) = points.iter().position(Point::is_finite) {
                seen.add(first, row);
                let last = points.iter().rposition(Point::is_finite).unwrap_or(first);
                seen.add(last, row);
            }
            let start = (row * cloud.width()) as u32;
            let inside = (start..)
                .zip(points)
                .filter(|(_, point)| self.contains(point));
            pixels.extend(inside.map(|(pixel, _)| pixel));
        }
        seen
    }
}
