//! Grid of the nearest surfels: a lookup for many places around a surface.

use crate::surfels::Surfel;
use crate::view_surface::ViewSurface;
use nalgebra::{Point3, Vector3};

/// Side of the cells, metres. Chosen: below the tolerance of the scores that use it.
const CELL_M: f64 = 0.004;

/// Greatest number of cells along a side; larger cells for larger surfaces.
const N_CELLS_MAX: f64 = 64.0;

/// Index in place of that of a surfel.
const NO_SURFEL: u32 = u32::MAX;

/// Index of the surfel that is nearest to the middle of each cell, within a reach.
#[derive(Debug, Clone)]
pub(crate) struct NearestSurfelGrid {
    first: Vector3<f64>,
    cell_m: f64,
    n_cells: [usize; 3],
    nearest: Vec<u32>,
}

impl NearestSurfelGrid {
    /// Grid over a surface and the reach around it, metres.
    pub(crate) fn new(surface: &ViewSurface, reach_m: f64) -> Self {
        let places = || surface.surfels().iter().map(|surfel| surfel.place.coords);
        let margin = Vector3::repeat(reach_m);
        let least = places().reduce(|a, b| a.inf(&b)).unwrap_or_default() - margin;
        let greatest = places().reduce(|a, b| a.sup(&b)).unwrap_or_default() + margin;
        let cell_m = CELL_M.max((greatest - least).max() / N_CELLS_MAX);
        let n_cells = std::array::from_fn(|axis| ((greatest - least)[axis] / cell_m) as usize + 1);
        let mut grid = Self {
            first: least,
            cell_m,
            n_cells,
            nearest: Vec::new(),
        };
        let n = n_cells.iter().product();
        let found = |index| surface.nearest_index(&grid.middle(index), reach_m);
        let nearest = (0..n).map(|index| found(index).map_or(NO_SURFEL, |found| found as u32));
        grid.nearest = nearest.collect();
        grid
    }

    /// Surfel near a place, of those of the surface: the nearest to the middle of its cell.
    pub(crate) fn near<'a>(
        &self,
        surfels: &'a [Surfel],
        place: &Point3<f64>,
    ) -> Option<&'a Surfel> {
        let cell = (place.coords - self.first) / self.cell_m;
        let mut index = 0;
        for axis in [2, 1, 0] {
            // A negative number becomes zero in a cast, which is a cell of the margin.
            let along = cell[axis] as usize;
            if along >= self.n_cells[axis] {
                return None;
            }
            index = index * self.n_cells[axis] + along;
        }
        surfels.get(self.nearest[index] as usize)
    }

    fn middle(&self, index: usize) -> Point3<f64> {
        let [width, height, _] = self.n_cells;
        let cell = [
            index % width,
            index / width % height,
            index / width / height,
        ];
        let offset = Vector3::from(cell.map(|along| along as f64 + 0.5)) * self.cell_m;
        Point3::from(self.first + offset)
    }
}
