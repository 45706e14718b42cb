//! Polygonal prism filter: pixels above the table.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::parallelism::{Parallelism, for_each};
use crate::samples::{is_in_range, sideways_max_m};
use crate::support_plane_holes::SupportPlaneHoles;
use crate::table::Table;
use crate::table_surface::TableSurface;
use point_cloud::{OrganizedCloud, Point};
use sensor_noise::DepthNoise;

/// Least height over the table in sigmas of the depth noise. Chosen.
const NOISE_SIGMAS: f32 = 3.0;

/// Number of points tested together in one vectorised block.
const BLOCK: usize = 8;

/// Number of image bands that are searched in parallel.
const N_BANDS: usize = 16;

/// Greatest number of points on which the overlap of a cluster with the table is measured.
const N_OVERLAP_SAMPLES: usize = 512;

/// Prism above the table, prepared for the inner loop.
pub(crate) struct Prism<'a> {
    z_range: [f32; 2],
    height_range: [f32; 2],
    noise: DepthNoise,
    height: AffineForm,
    u: AffineForm,
    v: AffineForm,
    surface: &'a TableSurface,
    holes: &'a SupportPlaneHoles,
}

/// Noise-dependent least height over the table, metres: `height_min_m` or more at depth
/// `z`.
#[inline]
pub(crate) fn lowest_m(z: f32, height_min_m: f32, noise: &DepthNoise) -> f32 {
    height_min_m.max(NOISE_SIGMAS * noise.sigma_m(z))
}

impl<'a> Prism<'a> {
    /// Prism above a table, extended by the holes of the support plane.
    pub(crate) fn over(
        table: &Table,
        config: &RawConfig,
        holes: &'a SupportPlaneHoles,
        surface: &'a TableSurface,
    ) -> Self {
        let [u, v, height] = AffineForm::coordinates_of(&table.table_from_camera);
        Self {
            z_range: [config.range_min_m as f32, config.range_max_m as f32],
            height_range: [config.height_min_m as f32, config.height_max_m as f32],
            noise: table.depth_noise,
            height,
            u,
            v,
            surface,
            holes,
        }
    }

    /// Depth and height test of a point. Branch-free, because the outcome changes too often
    /// from pixel to pixel to be predicted.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "unpredictable branches cost more than comparisons"
    )]
    fn is_in_slab(&self, point: &Point) -> bool {
        let height = self.height.at(point.x, point.y, point.z);
        is_in_range(point, self.z_range[0], self.z_range[1])
            & (height >= lowest_m(point.z, self.height_range[0], &self.noise))
            & (height <= self.height_range[1])
    }

    /// Conservative height test of a block: `false` when no point is within the heights of
    /// the prism. Most of an image is table or lower.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "unpredictable branches cost more than comparisons"
    )]
    fn block_meets_slab(&self, block: &[Point; BLOCK]) -> bool {
        let [lowest, highest] = self.height_range;
        block.iter().fold(false, |any, point| {
            let height = self.height.at(point.x, point.y, point.z);
            any | ((height >= lowest) & (height <= highest))
        })
    }

    /// Prism test of each point of a block, coordinate by coordinate, so that the compiler
    /// vectorises it.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "unpredictable branches cost more than comparisons"
    )]
    fn block_mask(&self, block: &[Point; BLOCK]) -> [bool; BLOCK] {
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for i in 0..BLOCK {
            (x[i], y[i], z[i]) = (block[i].x, block[i].y, block[i].z);
        }
        let side_max = sideways_max_m(self.z_range[1]);
        let (mut is_in_slab, mut cells) = ([false; BLOCK], [0; BLOCK]);
        for i in 0..BLOCK {
            let [u, v, height] =
                [&self.u, &self.v, &self.height].map(|axis| axis.at(x[i], y[i], z[i]));
            cells[i] = self.surface.cell_index(u, v);
            is_in_slab[i] = (z[i] >= self.z_range[0])
                & (z[i] <= self.z_range[1])
                & (x[i].abs() <= side_max)
                & (y[i].abs() <= side_max)
                & (height >= lowest_m(z[i], self.height_range[0], &self.noise))
                & (height <= self.height_range[1]);
        }
        std::array::from_fn(|i| is_in_slab[i] & self.surface.is_near_cell(cells[i]))
    }

    /// `true` when a point is above the table or near its rim, at any height.
    #[inline]
    fn is_near_table(&self, point: &Point) -> bool {
        self.surface.is_near(
            self.u.at(point.x, point.y, point.z),
            self.v.at(point.x, point.y, point.z),
        )
    }

    /// `true` when a pixel is in a hole of the support plane.
    #[inline]
    fn is_in_hole(&self, column: usize, row: usize, point: &Point) -> bool {
        is_in_range(point, self.z_range[0], self.z_range[1])
            && self
                .holes
                .contains(column, row, self.height.at(point.x, point.y, point.z))
    }

    /// List the pixels in the prism, in image order; `bands` is scratch memory.
    pub(crate) fn list_pixels(
        &self,
        cloud: &OrganizedCloud<'_>,
        parallelism: &dyn Parallelism,
        bands: &mut Vec<Vec<u32>>,
        pixels: &mut Vec<u32>,
    ) {
        let n_rows = cloud.height().div_ceil(N_BANDS).max(1);
        bands.resize_with(cloud.height().div_ceil(n_rows), Vec::new);
        let first_rows = (0..).step_by(n_rows);
        for_each(
            parallelism,
            bands.iter_mut().zip(first_rows),
            |(band, first)| {
                band.clear();
                for row in first..cloud.height().min(first + n_rows) {
                    self.list_row(cloud, row, band);
                }
            },
        );
        pixels.clear();
        for band in bands {
            pixels.extend_from_slice(band);
        }
    }

    /// List the pixels of a row that are in the prism.
    fn list_row(&self, cloud: &OrganizedCloud<'_>, row: usize, pixels: &mut Vec<u32>) {
        let points = cloud.row(row);
        let start = (row * cloud.width()) as u32;
        if self.holes.intersects_row(row) {
            let inside = (0..).zip(points).filter(|&(column, point)| {
                self.is_in_slab(point) && self.is_near_table(point)
                    || self.is_in_hole(column as usize, row, point)
            });
            pixels.extend(inside.map(|(column, _)| start + column));
        } else {
            self.list_row_without_holes(start, points, pixels);
        }
    }

    /// List the pixels of a row without holes, block by block.
    fn list_row_without_holes(&self, start: u32, points: &[Point], pixels: &mut Vec<u32>) {
        let n_before = pixels.len();
        pixels.resize(n_before + points.len(), 0);
        let row = &mut pixels[n_before..];
        let (mut n_inside, mut pixel) = (0, start);
        let (blocks, rest) = points.as_chunks::<BLOCK>();
        for block in blocks {
            if !self.block_meets_slab(block) {
                pixel += BLOCK as u32;
                continue;
            }
            for is_inside in self.block_mask(block) {
                row[n_inside] = pixel;
                n_inside += usize::from(is_inside);
                pixel += 1;
            }
        }
        for point in rest {
            row[n_inside] = pixel;
            n_inside += usize::from(self.is_in_slab(point) && self.is_near_table(point));
            pixel += 1;
        }
        pixels.truncate(n_before + n_inside);
    }
}

/// Overlap test of clusters with the table's cells.
pub(crate) struct TableOverlap<'a> {
    u: AffineForm,
    v: AffineForm,
    surface: &'a TableSurface,
}

impl<'a> TableOverlap<'a> {
    /// Overlap test for a table.
    pub(crate) fn new(table: &Table, surface: &'a TableSurface) -> Self {
        let [u, v, _] = AffineForm::coordinates_of(&table.table_from_camera);
        Self { u, v, surface }
    }

    /// Share of a cluster's points above the table's cells, of a sample of the points.
    pub(crate) fn share(&self, pixels: &[u32], cloud: &OrganizedCloud<'_>) -> f64 {
        let stride = pixels.len().div_ceil(N_OVERLAP_SAMPLES).max(1);
        let is_inside = |&&pixel: &&u32| {
            let p = &cloud.points()[pixel as usize];
            self.surface
                .is_table(self.u.at(p.x, p.y, p.z), self.v.at(p.x, p.y, p.z))
        };
        let sampled = pixels.iter().step_by(stride);
        let n = sampled.len().max(1);
        sampled.filter(is_inside).count() as f64 / n as f64
    }
}
