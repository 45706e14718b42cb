//! Largest wide connected region of a plane's voxel centroids and its polygon.

use super::voxel_centroids::VoxelCentroids;
use crate::affine_form::AffineForm;
use geometry::{ConvexPolygon, RigidTransform};
use nalgebra::Point2;

/// Least side of an occupancy cell on the plane, metres. Chosen.
const CELL_M: f32 = 0.04;

/// Least side of an occupancy cell on the plane, voxels. Chosen.
const CELL_VOXELS: f32 = 2.5;

/// Greatest number of cells per side; a larger plane gets larger cells.
const CELLS_MAX: usize = 512;

/// Least number of centroids in an occupied cell. Chosen.
const COVERED_MIN: u32 = 2;

/// Greatest gap bridged within a region, cells: objects on the table occlude parts of it.
/// Chosen.
const GAP_CELLS: isize = 3;

/// Connected plane region found last, with buffers.
#[derive(Debug, Default)]
pub(super) struct VoxelPlaneRegion {
    placed: Vec<(u32, [f32; 2])>,
    counts: Vec<u32>,
    is_wide: Vec<bool>,
    is_taken: Vec<bool>,
    stack: Vec<usize>,
    region: Vec<usize>,
    best: Vec<usize>,
    outline: Vec<Point2<f64>>,
}

/// Occupancy grid over a plane.
#[derive(Debug, Clone, Copy)]
struct PlaneCells {
    low: [f32; 2],
    cell_m: f32,
    size: [usize; 2],
}

impl PlaneCells {
    fn around(placed: &[(u32, [f32; 2])], cell_m: f32) -> Self {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for (_, at) in placed {
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]);
        let cell_m = cell_m.max(extent_m / (CELLS_MAX - 1) as f32);
        // One empty cell on each side.
        let size = [0, 1].map(|axis| ((high[axis] - low[axis]) / cell_m) as usize + 3);
        Self { low, cell_m, size }
    }

    #[inline]
    fn cell_of(&self, at: [f32; 2]) -> usize {
        let index = |axis: usize| {
            (((at[axis] - self.low[axis]) / self.cell_m) as usize + 1).min(self.size[axis] - 2)
        };
        index(1) * self.size[0] + index(0)
    }

    /// Cells at most `reach` rows and columns away.
    fn around_cell(&self, cell: usize, reach: isize) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.size;
        let (column, row) = (cell % width, cell / width);
        let span = |at: usize, n: usize| {
            at.saturating_sub(reach as usize)..=(at + reach as usize).min(n - 1)
        };
        let columns = span(column, width);
        span(row, height)
            .flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

impl VoxelPlaneRegion {
    /// Find the largest region of the unassigned centroids in a plane's band; returns their
    /// number. z of the plane's frame is the height.
    pub(super) fn find(
        &mut self,
        centroids: &VoxelCentroids,
        plane_from_cloud: &RigidTransform,
        band_m: f32,
        voxel_m: f32,
    ) -> usize {
        let [u, v, height] = AffineForm::coordinates_of(plane_from_cloud);
        self.placed.clear();
        self.placed
            .extend(centroids.unassigned_in_band(&height, band_m).map(|i| {
                (
                    i as u32,
                    [centroids.coordinate(&u, i), centroids.coordinate(&v, i)],
                )
            }));
        if self.placed.is_empty() {
            return 0;
        }
        let cells = PlaneCells::around(&self.placed, CELL_M.max(CELL_VOXELS * voxel_m));
        self.count(&cells);
        self.mark_wide(&cells);
        self.keep_largest(&cells);
        self.placed.len()
    }

    /// Voxel centroids of the region found last.
    pub(super) fn members(&self) -> impl Iterator<Item = usize> + '_ {
        self.placed.iter().map(|&(i, _)| i as usize)
    }

    /// Convex hull of the region found last, in the frame of the plane.
    pub(super) fn polygon(&mut self) -> ConvexPolygon {
        self.outline.clear();
        let corner = |at: [f32; 2]| Point2::new(f64::from(at[0]), f64::from(at[1]));
        self.outline
            .extend(self.placed.iter().map(|&(_, at)| corner(at)));
        ConvexPolygon::convex_hull_of(&mut self.outline)
    }

    fn count(&mut self, cells: &PlaneCells) {
        self.counts.clear();
        self.counts.resize(cells.size[0] * cells.size[1], 0);
        for &(_, at) in &self.placed {
            self.counts[cells.cell_of(at)] += 1;
        }
    }

    /// Mark fully occupied squares of three by three cells and the occupied cells around
    /// them. Rejects strips, in which a plane cuts through walls and chairs.
    fn mark_wide(&mut self, cells: &PlaneCells) {
        let Self {
            counts, is_wide, ..
        } = self;
        is_wide.clear();
        is_wide.resize(counts.len(), false);
        for row in 1..cells.size[1] - 1 {
            for column in 1..cells.size[0] - 1 {
                let cell = row * cells.size[0] + column;
                if cells
                    .around_cell(cell, 1)
                    .all(|near| counts[near] >= COVERED_MIN)
                {
                    for near in cells.around_cell(cell, 2) {
                        is_wide[near] |= counts[near] > 0;
                    }
                }
            }
        }
    }

    fn keep_largest(&mut self, cells: &PlaneCells) {
        self.is_taken.clear();
        self.is_taken.resize(self.counts.len(), false);
        self.best.clear();
        let mut n_best = 0;
        for start in 0..self.counts.len() {
            if self.is_wide[start] && !self.is_taken[start] {
                let n = self.flood(cells, start);
                if n > n_best {
                    n_best = n;
                    std::mem::swap(&mut self.best, &mut self.region);
                }
            }
        }
        let Self {
            is_taken,
            best,
            placed,
            ..
        } = self;
        is_taken.fill(false);
        for &cell in best.iter() {
            is_taken[cell] = true;
        }
        placed.retain(|&(_, at)| is_taken[cells.cell_of(at)]);
    }

    /// Flood fill of the wide cells connected with `start` into `region`; returns the
    /// number of their centroids.
    fn flood(&mut self, cells: &PlaneCells, start: usize) -> u64 {
        let mut n = 0;
        self.region.clear();
        self.stack.push(start);
        self.is_taken[start] = true;
        while let Some(cell) = self.stack.pop() {
            n += u64::from(self.counts[cell]);
            self.region.push(cell);
            for near in cells.around_cell(cell, GAP_CELLS) {
                if self.is_wide[near] && !self.is_taken[near] {
                    self.is_taken[near] = true;
                    self.stack.push(near);
                }
            }
        }
        n
    }
}
