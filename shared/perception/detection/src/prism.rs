//! The points over the table.

use crate::RawConfig;
use crate::axis::Axis;
use crate::crew::{Crew, each};
use crate::islands::Islands;
use crate::samples::{is_in_range, side_max_m};
use crate::table_plane::Table;
use crate::table_surface::TableSurface;
use point_cloud::{OrganizedCloud, Point};
use sensor_noise::depth_sigma_m;

/// What lies over the table must be higher than this many sigma of the height
/// noise.
const NOISE_SIGMAS: f32 = 3.0;

/// The outermost columns with depth are looked for in each of so many rows.
const ROWS_STEP: usize = 8;

/// Points that are looked at together.
const BLOCK: usize = 8;

/// The image is searched in so many bands of rows.
const N_BANDS: usize = 16;

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

    /// The part of a cloud: its first and last row with any depth, and the
    /// outermost columns of every few rows.
    pub(crate) fn of(cloud: &OrganizedCloud<'_>) -> Self {
        let mut seen = Self::NOTHING;
        let first = |row: usize| cloud.row(row).iter().position(Point::is_finite);
        let mut add_row = |row: usize| {
            if let Some(column) = first(row) {
                seen.add(column, row);
                let last = cloud.row(row).iter().rposition(Point::is_finite);
                seen.add(last.unwrap_or(column), row);
            }
        };
        let mut rows = 0..cloud.height();
        let top = rows.find(|&row| first(row).is_some());
        let bottom = rows.rfind(|&row| first(row).is_some());
        top.into_iter().chain(bottom).for_each(&mut add_row);
        (0..cloud.height()).step_by(ROWS_STEP).for_each(add_row);
        seen
    }

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
    surface: &'a TableSurface,
    islands: &'a Islands,
}

/// How high a point must lie to be over the table, metres; `height_min_m` where
/// the noise of depth is less.
#[inline]
pub(crate) fn lowest_m(z: f32, height_min_m: f32) -> f32 {
    height_min_m.max(NOISE_SIGMAS * depth_sigma_m(z))
}

impl<'a> Prism<'a> {
    /// The prism over a table, with what lies lower on its islands.
    pub(crate) fn over(
        table: &Table,
        config: &RawConfig,
        islands: &'a Islands,
        surface: &'a TableSurface,
    ) -> Self {
        let [u, v, height] = Axis::of_transform(&table.table_from_camera);
        Self {
            z_range: [config.range_min_m as f32, config.range_max_m as f32],
            height_range: [config.height_min_m as f32, config.height_max_m as f32],
            height,
            u,
            v,
            surface,
            islands,
        }
    }

    /// Whether a point lies as high as the prism. Without a branch: the answer
    /// changes too often from pixel to pixel to be foreseen.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "branches that can not be foreseen cost more than comparisons"
    )]
    fn is_high(&self, point: &Point) -> bool {
        let height = self.height.at(point.x, point.y, point.z);
        is_in_range(point, self.z_range[0], self.z_range[1])
            & (height >= lowest_m(point.z, self.height_range[0]))
            & (height <= self.height_range[1])
    }

    /// False for a block without any point of the prism's heights: most of an image is
    /// table and what is lower.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "branches that can not be foreseen cost more than comparisons"
    )]
    fn may_be_high(&self, block: &[Point; BLOCK]) -> bool {
        let [lowest, highest] = self.height_range;
        block.iter().fold(false, |any, point| {
            let height = self.height.at(point.x, point.y, point.z);
            any | ((height >= lowest) & (height <= highest))
        })
    }

    /// [`is_high`](Self::is_high) of each point of a block, coordinate by
    /// coordinate, which the compiler turns into vector instructions.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "branches that can not be foreseen cost more than comparisons"
    )]
    fn are_high(&self, block: &[Point; BLOCK]) -> [bool; BLOCK] {
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for i in 0..BLOCK {
            (x[i], y[i], z[i]) = (block[i].x, block[i].y, block[i].z);
        }
        let side_max = side_max_m(self.z_range[1]);
        let mut are_high = [false; BLOCK];
        for i in 0..BLOCK {
            let height = self.height.at(x[i], y[i], z[i]);
            are_high[i] = (z[i] >= self.z_range[0])
                & (z[i] <= self.z_range[1])
                & (x[i].abs() <= side_max)
                & (y[i].abs() <= side_max)
                & (height >= lowest_m(z[i], self.height_range[0]))
                & (height <= self.height_range[1]);
        }
        are_high
    }

    /// Whether a point lies over the table or near its rim, at any height.
    #[inline]
    fn is_over(&self, point: &Point) -> bool {
        self.surface.is_near(
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

    /// Lists the pixels in the prism, in image order; `bands` is scratch memory.
    pub(crate) fn list(
        &self,
        cloud: &OrganizedCloud<'_>,
        crew: &dyn Crew,
        bands: &mut Vec<Vec<u32>>,
        pixels: &mut Vec<u32>,
    ) {
        let n_rows = cloud.height().div_ceil(N_BANDS).max(1);
        bands.resize_with(cloud.height().div_ceil(n_rows), Vec::new);
        let first_rows = (0..).step_by(n_rows);
        each(crew, bands.iter_mut().zip(first_rows), |(band, first)| {
            band.clear();
            for row in first..cloud.height().min(first + n_rows) {
                self.list_row_of(cloud, row, band);
            }
        });
        pixels.clear();
        for band in bands {
            pixels.extend_from_slice(band);
        }
    }

    /// Lists the pixels of a row.
    fn list_row_of(&self, cloud: &OrganizedCloud<'_>, row: usize, pixels: &mut Vec<u32>) {
        let points = cloud.row(row);
        let start = (row * cloud.width()) as u32;
        if self.islands.reach_row(row) {
            let inside = (0..).zip(points).filter(|&(column, point)| {
                self.is_high(point) && self.is_over(point)
                    || self.is_on_island(column as usize, row, point)
            });
            pixels.extend(inside.map(|(column, _)| start + column));
        } else {
            self.list_row(start, points, pixels);
        }
    }

    /// Lists the pixels of a row without islands: first what is high, then what
    /// of that lies over the table.
    fn list_row(&self, start: u32, points: &[Point], pixels: &mut Vec<u32>) {
        let n_before = pixels.len();
        pixels.resize(n_before + points.len(), 0);
        let row = &mut pixels[n_before..];
        let (mut n_high, mut column) = (0, 0);
        let (blocks, rest) = points.as_chunks::<BLOCK>();
        for block in blocks {
            if !self.may_be_high(block) {
                column += BLOCK as u32;
                continue;
            }
            for is_high in self.are_high(block) {
                row[n_high] = column;
                n_high += usize::from(is_high);
                column += 1;
            }
        }
        for point in rest {
            row[n_high] = column;
            n_high += usize::from(self.is_high(point));
            column += 1;
        }
        let mut n_inside = 0;
        for i in 0..n_high {
            let column = row[i];
            row[n_inside] = start + column;
            n_inside += usize::from(self.is_over(&points[column as usize]));
        }
        pixels.truncate(n_before + n_inside);
    }
}

/// Tells which clusters lie over the table and not mostly beside it.
pub(crate) struct OverTable<'a> {
    u: Axis,
    v: Axis,
    surface: &'a TableSurface,
}

impl<'a> OverTable<'a> {
    /// The test for a table.
    pub(crate) fn new(table: &Table, surface: &'a TableSurface) -> Self {
        let [u, v, _] = Axis::of_transform(&table.table_from_camera);
        Self { u, v, surface }
    }

    /// Whether enough of a cluster's points lie over the table.
    pub(crate) fn holds(&self, pixels: &[u32], cloud: &OrganizedCloud<'_>) -> bool {
        let is_inside = |&&pixel: &&u32| {
            let p = &cloud.points()[pixel as usize];
            self.surface
                .is_table(self.u.at(p.x, p.y, p.z), self.v.at(p.x, p.y, p.z))
        };
        let n_needed = (OVER_TABLE_SHARE_MIN * pixels.len() as f64).ceil() as usize;
        pixels.iter().filter(is_inside).take(n_needed).count() >= n_needed
    }
}
