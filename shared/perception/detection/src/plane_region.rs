//! Largest connected region of a plane's inliers and its polygon.

use crate::affine_form::AffineForm;
use crate::plane_ransac::least_squares_plane;
use crate::samples::Samples;
use geometry::{ConvexPolygon, Plane};
use nalgebra::{Point2, Point3};
use point_cloud::{Moments, PrincipalAxes};

/// Least side of an occupancy cell on the plane, metres. Chosen.
pub(crate) const CELL_M: f32 = 0.04;

/// Greatest number of cells per side in an image; a larger plane gets larger cells.
const CELLS_MAX: usize = 256;

/// Least number of samples in an occupied cell. Chosen.
const CELL_SAMPLES_MIN: u32 = 2;

/// Greatest gap bridged within a region, cells: objects on the table occlude parts of it.
/// Chosen.
const GAP_CELLS: usize = 3;

/// Connected plane region found last, with buffers.
#[derive(Debug, Default)]
pub(crate) struct PlaneRegionBuffers {
    inliers: Vec<Inlier>,
    /// Number of samples of each connected region.
    sizes: Vec<u32>,
    n_in_cell: Vec<u32>,
    is_table: Vec<bool>,
    region_of_cell: Vec<u32>,
    stack: Vec<usize>,
    outline: Vec<Point2<f64>>,
}

/// Inlier of a plane: sample index, coordinates in the frame of the plane, metres, and cell of
/// the occupancy grid.
#[derive(Debug, Clone, Copy)]
struct Inlier {
    sample: u32,
    u: f32,
    v: f32,
    cell: u32,
}

impl PlaneRegionBuffers {
    /// Samples of the region found last, in the order of the image.
    pub(crate) fn samples(&self) -> impl Iterator<Item = usize> {
        self.inliers.iter().map(|inlier| inlier.sample as usize)
    }

    /// Number of samples of the region found last.
    pub(crate) fn n_samples(&self) -> usize {
        self.inliers.len()
    }

    /// Number of connected regions with at least `n_min` samples.
    pub(crate) fn n_regions_of_at_least(&self, n_min: usize) -> usize {
        let is_large = |&&size: &&u32| size as usize >= n_min;
        self.sizes.iter().filter(is_large).count()
    }
}

/// Occupancy grid over a set of inliers.
#[derive(Debug, Clone, Copy)]
struct CellGrid {
    u_min: f32,
    v_min: f32,
    cell_m: f32,
    width: usize,
    height: usize,
}

impl CellGrid {
    fn around(inliers: &[Inlier], rule: &RegionRule) -> Self {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for inlier in inliers {
            low = [low[0].min(inlier.u), low[1].min(inlier.v)];
            high = [high[0].max(inlier.u), high[1].max(inlier.v)];
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]);
        let n_max = rule.n_cells_max;
        let cell_m = rule.cell_m.max(extent_m / (n_max - 1) as f32);
        let n_cells = |i: usize| (((high[i] - low[i]) / cell_m) as usize + 1).min(n_max);
        Self {
            u_min: low[0],
            v_min: low[1],
            cell_m,
            width: n_cells(0),
            height: n_cells(1),
        }
    }

    #[inline]
    fn cell_of(&self, inlier: &Inlier) -> usize {
        let column = ((inlier.u - self.u_min) / self.cell_m) as usize;
        let row = ((inlier.v - self.v_min) / self.cell_m) as usize;
        row.min(self.height - 1) * self.width + column.min(self.width - 1)
    }

    /// Cells at most `reach` rows and columns away, with their distance.
    fn around_cell(&self, cell: usize, reach: usize) -> impl Iterator<Item = (usize, usize)> {
        let Self { width, height, .. } = *self;
        let (column, row) = (cell % width, cell / width);
        let span = |at: usize, n: usize| at.saturating_sub(reach)..=(at + reach).min(n - 1);
        let columns = span(column, width);
        span(row, height).flat_map(move |near_row| {
            columns.clone().map(move |near_column| {
                let distance = row.abs_diff(near_row).max(column.abs_diff(near_column));
                (near_row * width + near_column, distance)
            })
        })
    }
}

/// Filter on the connected regions of a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RegionFilter {
    /// Accept only regions that are somewhere wider than a strip.
    WideOnly,
    /// Accept only the wide parts of regions.
    WideParts,
    /// Accept all plane regions, including narrow strips.
    All,
}

/// Rule of the region search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionRule {
    /// Least side of an occupancy cell, metres.
    pub(crate) cell_m: f32,
    /// Greatest number of cells per side; a larger plane gets larger cells.
    pub(crate) n_cells_max: usize,
    pub(crate) parts: RegionFilter,
}

/// Find the largest connected region of a plane's inliers in an image and keep it in
/// `buffers`. Returns its number of samples.
pub(crate) fn find_region(
    samples: &Samples,
    plane: &Plane,
    parts: RegionFilter,
    buffers: &mut PlaneRegionBuffers,
) -> usize {
    let [u, v, _] = AffineForm::coordinates_of(&plane.plane_from_source());
    let rule = RegionRule {
        cell_m: CELL_M,
        n_cells_max: CELLS_MAX,
        parts,
    };
    find_region_along(samples, &[u, v, AffineForm::from(plane)], &rule, buffers)
}

/// Find the largest connected region of a plane's inliers, by the coordinates of the plane's
/// frame, and keep it in `buffers`. Returns its number of samples.
pub(crate) fn find_region_along(
    samples: &Samples,
    [u, v, height]: &[AffineForm; 3],
    rule: &RegionRule,
    buffers: &mut PlaneRegionBuffers,
) -> usize {
    buffers.sizes.clear();
    buffers.inliers.clear();
    samples.visit_inliers(height, |sample, [x, y, z]| {
        buffers.inliers.push(Inlier {
            sample: sample as u32,
            u: u.at(x, y, z),
            v: v.at(x, y, z),
            cell: 0,
        });
    });
    if buffers.inliers.is_empty() {
        return 0;
    }
    let grid = CellGrid::around(&buffers.inliers, rule);
    buffers.n_in_cell.clear();
    buffers.n_in_cell.resize(grid.width * grid.height, 0);
    for inlier in &mut buffers.inliers {
        let cell = grid.cell_of(inlier);
        inlier.cell = cell as u32;
        buffers.n_in_cell[cell] += 1;
    }
    match rule.parts {
        RegionFilter::WideOnly | RegionFilter::WideParts => {
            keep_wide_parts(&grid, rule.parts, buffers);
        }
        RegionFilter::All => {
            let covered = buffers.n_in_cell.iter().map(|&n| n >= CELL_SAMPLES_MIN);
            buffers.is_table.clear();
            buffers.is_table.extend(covered);
        }
    }
    let largest = largest_region(&grid, rule.parts, buffers);
    let regions = &buffers.region_of_cell;
    buffers
        .inliers
        .retain(|inlier| regions[inlier.cell as usize] == largest);
    buffers.inliers.len()
}

/// Mark fully occupied squares of three by three cells and the occupied cells around them.
/// Rejects strips, in which a plane cuts through chairs and walls.
fn keep_wide_parts(grid: &CellGrid, parts: RegionFilter, buffers: &mut PlaneRegionBuffers) {
    let PlaneRegionBuffers {
        n_in_cell,
        is_table,
        ..
    } = buffers;
    is_table.clear();
    is_table.resize(n_in_cell.len(), false);
    for row in 1..grid.height.saturating_sub(1) {
        for column in 1..grid.width.saturating_sub(1) {
            let cell = row * grid.width + column;
            let mut square = grid.around_cell(cell, 1);
            if square.all(|(near, _)| n_in_cell[near] >= CELL_SAMPLES_MIN) {
                let inner = parts == RegionFilter::WideParts
                    || (2..grid.height - 2).contains(&row) && (2..grid.width - 2).contains(&column);
                let reach = if inner { 2 } else { 1 };
                for (near, _) in grid.around_cell(cell, reach) {
                    is_table[near] |= n_in_cell[near] > 0;
                }
            }
        }
    }
}

/// Number of the region with the most samples, counted from 1.
fn largest_region(grid: &CellGrid, parts: RegionFilter, buffers: &mut PlaneRegionBuffers) -> u32 {
    buffers.region_of_cell.clear();
    buffers.region_of_cell.resize(buffers.n_in_cell.len(), 0);
    let (mut largest, mut n_largest) = (u32::MAX, 0);
    for start in 0..buffers.n_in_cell.len() {
        if buffers.is_table[start] && buffers.region_of_cell[start] == 0 {
            let region = buffers.sizes.len() as u32 + 1;
            let n_samples = flood(grid, parts, start, region, buffers);
            buffers.sizes.push(n_samples);
            if n_samples > n_largest {
                (largest, n_largest) = (region, n_samples);
            }
        }
    }
    largest
}

/// Flood fill of the cells connected with `start`; returns their number of samples.
fn flood(
    grid: &CellGrid,
    parts: RegionFilter,
    start: usize,
    region: u32,
    buffers: &mut PlaneRegionBuffers,
) -> u32 {
    let mut n_samples = 0;
    buffers.stack.clear();
    buffers.stack.push(start);
    buffers.region_of_cell[start] = region;
    while let Some(cell) = buffers.stack.pop() {
        n_samples += buffers.n_in_cell[cell];
        for (near, distance) in grid.around_cell(cell, GAP_CELLS) {
            // Most cells around one of the region are in the region already.
            if buffers.region_of_cell[near] != 0 {
                continue;
            }
            // A gap is bridged to a wide part only: behind the rim the plane also cuts
            // through the backs of chairs.
            let is_table = buffers.is_table[near];
            let joins = match parts {
                RegionFilter::WideParts => is_table,
                RegionFilter::WideOnly | RegionFilter::All => {
                    buffers.n_in_cell[near] >= CELL_SAMPLES_MIN && (is_table || distance <= 1)
                }
            };
            if joins {
                buffers.region_of_cell[near] = region;
                buffers.stack.push(near);
            }
        }
    }
    n_samples
}

/// Principal axes of the region found last; `None` for a degenerate region.
pub(crate) fn region_axes(samples: &Samples, region: &PlaneRegionBuffers) -> Option<PrincipalAxes> {
    let mut moments = Moments::default();
    for sample in region.samples() {
        moments.add(&samples.position(sample));
    }
    moments.principal_axes()
}

/// Least-squares plane of the region found last, facing the camera; `None` for a degenerate
/// region.
pub(crate) fn region_plane(samples: &Samples, region: &PlaneRegionBuffers) -> Option<Plane> {
    region_plane_and_middle(samples, region).map(|(plane, _)| plane)
}

/// [`region_plane`] with the middle of the region.
pub(crate) fn region_plane_and_middle(
    samples: &Samples,
    region: &PlaneRegionBuffers,
) -> Option<(Plane, Point3<f64>)> {
    let axes = region_axes(samples, region)?;
    let plane = least_squares_plane(&axes)?.facing(&Point3::origin());
    Some((plane, axes.centroid))
}

/// Convex hull of the region found last, in the frame of the plane.
///
/// The first and last sample of each image row suffice: a plane is seen through a
/// homography, which preserves betweenness.
pub(crate) fn region_polygon(
    samples: &Samples,
    buffers: &mut PlaneRegionBuffers,
    polygon: &mut ConvexPolygon,
) {
    let row_of = |inlier: &Inlier| inlier.sample as usize / samples.width();
    buffers.outline.clear();
    for row in buffers.inliers.chunk_by(|a, b| row_of(a) == row_of(b)) {
        for inlier in [&row[0], &row[row.len() - 1]] {
            let corner = Point2::new(f64::from(inlier.u), f64::from(inlier.v));
            buffers.outline.push(corner);
        }
    }
    polygon.assign_convex_hull_of(&mut buffers.outline);
}
