//! The points over the table.

use crate::RawConfig;
use crate::axis::Axis;
use crate::islands::Islands;
use crate::samples::is_in_range;
use crate::sensor_noise::depth_sigma_m;
use crate::table_plane::Table;
use crate::table_slabs::TableSlabs;
use point_cloud::{OrganizedCloud, Point};

/// What lies over the table must be higher than this many sigma of the height
/// noise.
const NOISE_SIGMAS: f32 = 3.0;

/// How far outside the polygon a point may lie, metres: objects stand at the rim
/// of what is seen of the table, hide it, and reach out over it.
const OVERHANG_M: f64 = 0.10;

/// What lies within the polygon, grown by this, is over the table, metres: the
/// seen table ends half a sample before its rim.
const POLYGON_MARGIN_M: f64 = 0.01;

/// An object has this share of its points over the table.
const OVER_TABLE_SHARE_MIN: f64 = 0.25;

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
    islands: &'a Islands,
}

/// How high a point must lie to be over the table, metres; `height_min_m` where
/// the noise of depth is less.
#[inline]
pub(crate) fn lowest_m(z: f32, height_min_m: f32) -> f32 {
    height_min_m.max(NOISE_SIGMAS * depth_sigma_m(z))
}

impl<'a> Prism<'a> {
    /// The prism over a table, with what lies lower on its islands; `slabs` are
    /// overwritten.
    pub(crate) fn over(
        table: &Table,
        config: &RawConfig,
        islands: &'a Islands,
        slabs: &'a mut TableSlabs,
    ) -> Self {
        slabs.refill(&table.polygon, OVERHANG_M);
        let [u, v, height] = Axis::of_transform(&table.table_from_camera);
        Self {
            z_range: [config.range_min_m as f32, config.range_max_m as f32],
            height_range: [config.height_min_m as f32, config.height_max_m as f32],
            height,
            u,
            v,
            slabs,
            islands,
        }
    }

    /// Whether a point lies in the prism.
    #[inline]
    fn contains(&self, point: &Point) -> bool {
        if !is_in_range(point, self.z_range[0], self.z_range[1]) {
            return false;
        }
        let height = self.height.at(point.x, point.y, point.z);
        (lowest_m(point.z, self.height_range[0])..=self.height_range[1]).contains(&height)
            && self.slabs.contains(
                self.u.at(point.x, point.y, point.z),
                self.v.at(point.x, point.y, point.z),
            )
    }

    /// Whether a point of an image lies on an island.
    #[inline]
    fn is_on_island(&self, column: usize, row: usize, point: &Point) -> bool {
        is_in_range(point, self.z_range[0], self.z_range[1])
            && self
                .islands
                .hold(column, row, self.height.at(point.x, point.y, point.z))
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
            let inside = (0..).zip(points).filter(|&(column, point)| {
                self.contains(point)
                    || self.islands.any() && self.is_on_island(column as usize, row, point)
            });
            pixels.extend(inside.map(|(column, _)| start + column));
        }
        seen
    }
}

/// Tells which clusters lie over the table and not mostly beside it.
pub(crate) struct OverTable<'a> {
    u: Axis,
    v: Axis,
    slabs: &'a TableSlabs,
}

impl<'a> OverTable<'a> {
    /// The test for a table; `slabs` are overwritten.
    pub(crate) fn new(table: &Table, slabs: &'a mut TableSlabs) -> Self {
        slabs.refill(&table.polygon, POLYGON_MARGIN_M);
        let [u, v, _] = Axis::of_transform(&table.table_from_camera);
        Self { u, v, slabs }
    }

    /// Whether enough of a cluster's points lie over the table.
    pub(crate) fn holds(&self, pixels: &[u32], cloud: &OrganizedCloud<'_>) -> bool {
        let is_inside = |&&pixel: &&u32| {
            let p = &cloud.points()[pixel as usize];
            self.slabs
                .contains(self.u.at(p.x, p.y, p.z), self.v.at(p.x, p.y, p.z))
        };
        let n_needed = (OVER_TABLE_SHARE_MIN * pixels.len() as f64).ceil() as usize;
        pixels.iter().filter(is_inside).take(n_needed).count() >= n_needed
    }
}
