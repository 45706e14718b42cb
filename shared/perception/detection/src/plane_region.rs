//! Largest connected region of a plane's inliers and its polygon.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use geometry::{ConvexPolygon, Plane, RigidTransform};
use nalgebra::{Point2, Point3, Unit};
use point_cloud::Moments;

/// Side of an occupancy cell on the plane, metres. Chosen.
const CELL_M: f32 = 0.04;

/// Greatest number of cells per side; a larger plane gets larger cells.
const CELLS_MAX: usize = 256;

/// Least number of samples in an occupied cell. Chosen.
const CELL_SAMPLES_MIN: u32 = 2;

/// Greatest gap bridged within a region, cells: objects on the table occlude parts of it.
/// Chosen.
const GAP_CELLS: isize = 3;

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
    fn around(inliers: &[Inlier]) -> Self {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for inlier in inliers {
            low = [low[0].min(inlier.u), low[1].min(inlier.v)];
            high = [high[0].max(inlier.u), high[1].max(inlier.v)];
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]);
        let cell_m = CELL_M.max(extent_m / (CELLS_MAX - 1) as f32);
        let n_cells = |i: usize| (((high[i] - low[i]) / cell_m) as usize + 1).min(CELLS_MAX);
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
}

/// Filter on the connected regions of a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RegionFilter {
    /// Accept only regions that are somewhere wider than a strip.
    WideOnly,
    /// Accept all plane regions, including narrow strips.
    All,
}

/// Find the largest connected region of a plane's inliers and keep it in `buffers`. Returns
/// its number of samples.
pub(crate) fn find_region(
    samples: &Samples,
    plane: &Plane,
    plane_from_camera: &RigidTransform,
    parts: RegionFilter,
    buffers: &mut PlaneRegionBuffers,
) -> usize {
    let height = AffineForm::from(plane);
    let [u, v, _] = AffineForm::coordinates_of(plane_from_camera);
    buffers.sizes.clear();
    buffers.inliers.clear();
    samples.visit_inliers(&height, |sample, [x, y, z]| {
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
    let grid = CellGrid::around(&buffers.inliers);
    buffers.n_in_cell.clear();
    buffers.n_in_cell.resize(grid.width * grid.height, 0);
    for inlier in &mut buffers.inliers {
        let cell = grid.cell_of(inlier);
        inlier.cell = cell as u32;
        buffers.n_in_cell[cell] += 1;
    }
    match parts {
        RegionFilter::WideOnly => keep_wide_parts(&grid, buffers),
        RegionFilter::All => {
            let covered = buffers.n_in_cell.iter().map(|&n| n >= CELL_SAMPLES_MIN);
            buffers.is_table.clear();
            buffers.is_table.extend(covered);
        }
    }
    let largest = largest_region(&grid, buffers);
    let regions = &buffers.region_of_cell;
    buffers
        .inliers
        .retain(|inlier| regions[inlier.cell as usize] == largest);
    buffers.inliers.len()
}

/// Mark fully occupied squares of three by three cells and the occupied cells around them.
/// Rejects strips, in which a plane cuts through chairs and walls.
fn keep_wide_parts(grid: &CellGrid, buffers: &mut PlaneRegionBuffers) {
    let PlaneRegionBuffers {
        n_in_cell,
        is_table,
        ..
    } = buffers;
    is_table.clear();
    is_table.resize(n_in_cell.len(), false);
    let around = |cell: usize, reach: isize| {
        let steps = -reach..=reach;
        steps.clone().flat_map(move |rows| {
            steps
                .clone()
                .map(move |columns| cell.wrapping_add_signed(rows * grid.width as isize + columns))
        })
    };
    for row in 1..grid.height.saturating_sub(1) {
        for column in 1..grid.width.saturating_sub(1) {
            let cell = row * grid.width + column;
            if around(cell, 1).all(|near| n_in_cell[near] >= CELL_SAMPLES_MIN) {
                let inner =
                    (2..grid.height - 2).contains(&row) && (2..grid.width - 2).contains(&column);
                let reach = if inner { 2 } else { 1 };
                around(cell, reach).for_each(|near| is_table[near] |= n_in_cell[near] > 0);
            }
        }
    }
}

/// Number of the region with the most samples, counted from 1.
fn largest_region(grid: &CellGrid, buffers: &mut PlaneRegionBuffers) -> u32 {
    buffers.region_of_cell.clear();
    buffers.region_of_cell.resize(buffers.n_in_cell.len(), 0);
    let (mut largest, mut n_largest) = (u32::MAX, 0);
    for start in 0..buffers.n_in_cell.len() {
        if buffers.is_table[start] && buffers.region_of_cell[start] == 0 {
            let region = buffers.sizes.len() as u32 + 1;
            let n_samples = flood(grid, start, region, buffers);
            buffers.sizes.push(n_samples);
            if n_samples > n_largest {
                (largest, n_largest) = (region, n_samples);
            }
        }
    }
    largest
}

/// Flood fill of the cells connected with `start`; returns their number of samples.
fn flood(grid: &CellGrid, start: usize, region: u32, buffers: &mut PlaneRegionBuffers) -> u32 {
    let mut n_samples = 0;
    buffers.stack.clear();
    buffers.stack.push(start);
    buffers.region_of_cell[start] = region;
    while let Some(cell) = buffers.stack.pop() {
        n_samples += buffers.n_in_cell[cell];
        let (column, row) = ((cell % grid.width) as isize, (cell / grid.width) as isize);
        let rows = (row - GAP_CELLS).max(0)..=(row + GAP_CELLS).min(grid.height as isize - 1);
        let from = (column - GAP_CELLS).max(0);
        let to = (column + GAP_CELLS).min(grid.width as isize - 1);
        for near_row in rows {
            for near_column in from..=to {
                let near = near_row as usize * grid.width + near_column as usize;
                // Most cells around one of the region are in the region already.
                if buffers.region_of_cell[near] != 0 || buffers.n_in_cell[near] < CELL_SAMPLES_MIN {
                    continue;
                }
                // A gap is bridged to a wide part only: behind the rim the plane also cuts
                // through the backs of chairs.
                let is_adjacent = row.abs_diff(near_row).max(column.abs_diff(near_column)) <= 1;
                if is_adjacent || buffers.is_table[near] {
                    buffers.region_of_cell[near] = region;
                    buffers.stack.push(near);
                }
            }
        }
    }
    n_samples
}

/// Moments of the plane region found last.
fn region_moments(samples: &Samples, buffers: &PlaneRegionBuffers) -> Moments {
    let mut moments = Moments::default();
    for inlier in &buffers.inliers {
        moments.add(&samples.position(inlier.sample as usize));
    }
    moments
}

/// Least-squares plane of the region found last, facing the camera; `None` for a degenerate
/// region.
pub(crate) fn region_plane(samples: &Samples, region: &PlaneRegionBuffers) -> Option<Plane> {
    let axes = region_moments(samples, region).principal_axes()?;
    let normal = Unit::try_new(axes.axes.column(2).into_owned(), 0.5)?;
    Some(Plane::through(&axes.centroid, normal).facing(&Point3::origin()))
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
