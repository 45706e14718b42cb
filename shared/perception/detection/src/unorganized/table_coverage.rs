//! Table coverage map: cells in which the table itself is visible.

use geometry::ConvexPolygon;

/// Cell size of the coverage map, metres. Chosen.
const CELL_M: f32 = 0.010;

/// Greatest number of cells per side; a larger table gets larger cells.
const CELLS_MAX: usize = 1024;

/// Table coverage map in the frame of the table.
#[derive(Debug, Default)]
pub(super) struct TableCoverage {
    low: [f32; 2],
    cell_m: f32,
    size: [usize; 2],
    is_seen: Vec<bool>,
}

impl TableCoverage {
    /// Clear the map and fit it to the bounds of a polygon.
    pub(super) fn clear(&mut self, polygon: &ConvexPolygon) {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for corner in polygon.corners() {
            for axis in 0..2 {
                low[axis] = low[axis].min(corner[axis] as f32);
                high[axis] = high[axis].max(corner[axis] as f32);
            }
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]).max(0.0);
        self.low = low;
        self.cell_m = CELL_M.max(extent_m / (CELLS_MAX - 1) as f32);
        self.size = [0, 1].map(|axis| ((high[axis] - low[axis]) / self.cell_m) as usize + 1);
        self.is_seen.clear();
        self.is_seen.resize(self.size[0] * self.size[1], false);
    }

    /// Mark the cell of a table point.
    #[inline]
    pub(super) fn add(&mut self, u: f32, v: f32) {
        if let Some(cell) = self.cell_of(u, v) {
            self.is_seen[cell] = true;
        }
    }

    /// `true` when the table is visible at a point.
    #[inline]
    pub(super) fn is_seen(&self, u: f32, v: f32) -> bool {
        self.cell_of(u, v).is_some_and(|cell| self.is_seen[cell])
    }

    #[inline]
    fn cell_of(&self, u: f32, v: f32) -> Option<usize> {
        let (column, row) = (
            (u - self.low[0]) / self.cell_m,
            (v - self.low[1]) / self.cell_m,
        );
        let inside = (0.0..self.size[0] as f32).contains(&column)
            && (0.0..self.size[1] as f32).contains(&row);
        inside.then(|| row as usize * self.size[0] + column as usize)
    }
}
