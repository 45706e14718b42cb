//! Cell grid over the table: cell lookup and morphology.

use geometry::ConvexPolygon;
use nalgebra::Point2;

/// Cell size, metres; a larger table gets larger cells. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const CELL_M: f64 = 0.02;

/// Greatest number of cells per side.
const CELLS_MAX: usize = 256;

/// Grid of square cells in the frame of the table.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CellGrid {
    u_min: f32,
    v_min: f32,
    cells_per_m: f32,
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl CellGrid {
    /// Grid around a polygon with a margin, metres.
    pub(crate) fn around(polygon: &ConvexPolygon, margin_m: f64) -> Self {
        let around = margin_m + 2.0 * CELL_M;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in polygon.corners() {
            for (i, at) in [corner.x, corner.y].into_iter().enumerate() {
                (low[i], high[i]) = (low[i].min(at - around), high[i].max(at + around));
            }
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]).max(CELL_M);
        let cell_m = CELL_M.max(extent_m / (CELLS_MAX - 1) as f64);
        let n_cells = |i: usize| {
            let n = ((high[i] - low[i]) / cell_m).ceil();
            if n.is_finite() {
                (n as usize).min(CELLS_MAX)
            } else {
                0
            }
        };
        Self {
            u_min: low[0] as f32,
            v_min: low[1] as f32,
            cells_per_m: (1.0 / cell_m) as f32,
            width: n_cells(0),
            height: n_cells(1),
        }
    }

    /// Number of cells.
    pub(crate) fn len(&self) -> usize {
        self.width * self.height
    }

    /// Side of a cell, metres.
    pub(crate) fn cell_m(&self) -> f64 {
        1.0 / f64::from(self.cells_per_m)
    }

    /// Number of cells that cover a length, metres, rounded up.
    pub(crate) fn n_cells(&self, length_m: f64) -> usize {
        (length_m * f64::from(self.cells_per_m)).ceil() as usize
    }

    /// Corner between four cells, table's frame.
    pub(crate) fn corner(&self, column: usize, row: usize) -> Point2<f64> {
        Point2::new(
            f64::from(self.u_min) + column as f64 * self.cell_m(),
            f64::from(self.v_min) + row as f64 * self.cell_m(),
        )
    }

    /// Centre of a cell, table's frame.
    pub(crate) fn centre(&self, cell: usize) -> Point2<f64> {
        let half_m = 0.5 * self.cell_m();
        let corner = self.corner(cell % self.width, cell / self.width);
        Point2::new(corner.x + half_m, corner.y + half_m)
    }

    /// Cell of a point in the table's frame; `None` outside of the grid.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "unpredictable branches cost more than comparisons"
    )]
    pub(crate) fn cell_of(&self, u: f32, v: f32) -> Option<usize> {
        let column = (u - self.u_min) * self.cells_per_m;
        let row = (v - self.v_min) * self.cells_per_m;
        let inside = (column >= 0.0)
            & (row >= 0.0)
            & (column < self.width as f32)
            & (row < self.height as f32);
        inside.then(|| row as usize * self.width + column as usize)
    }

    /// Neighbours of a cell by side. The outermost cells are never part of a table, except
    /// with very large cells, so wrapping around a row does no harm.
    pub(crate) fn neighbours(&self, cell: usize) -> [usize; 4] {
        let width = self.width as isize;
        [-1, 1, -width, width].map(|step| cell.wrapping_add_signed(step))
    }

    /// Morphological dilation with a square of `reach` columns and rows.
    pub(crate) fn dilate(
        &self,
        marked: &[bool],
        reach: usize,
        scratch: &mut Vec<bool>,
        dilated: &mut Vec<bool>,
    ) {
        for cells in [&mut *scratch, &mut *dilated] {
            cells.clear();
            cells.resize(marked.len(), false);
        }
        for row in 0..self.height {
            let line = row * self.width..(row + 1) * self.width;
            dilate_line(&marked[line.clone()], 1, reach, &mut scratch[line]);
        }
        for column in 0..self.width.min(marked.len()) {
            dilate_line(
                &scratch[column..],
                self.width,
                reach,
                &mut dilated[column..],
            );
        }
    }
}

/// One-dimensional dilation of a line with its cells `stride` apart.
fn dilate_line(marked: &[bool], stride: usize, reach: usize, dilated: &mut [bool]) {
    let n = marked.len().div_ceil(stride);
    let mut until = 0;
    for i in 0..n + reach {
        if i < n && marked[i * stride] {
            until = i + 2 * reach + 1;
        }
        if i < until && i >= reach {
            dilated[(i - reach) * stride] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn dilation_matches_brute_force(
            marked in prop::collection::vec(prop::bool::weighted(0.1), 12 * 9), reach in 0..4_usize,
        ) {
            let grid = CellGrid { width: 12, height: 9, ..CellGrid::default() };
            let (mut scratch, mut dilated) = (Vec::new(), Vec::new());
            grid.dilate(&marked, reach, &mut scratch, &mut dilated);
            for (i, &is_marked) in dilated.iter().enumerate() {
                let near = |&other: &usize| {
                    (i % 12).abs_diff(other % 12) <= reach && (i / 12).abs_diff(other / 12) <= reach
                };
                let expected = (0..marked.len()).filter(near).any(|other| marked[other]);
                prop_assert_eq!(is_marked, expected);
            }
        }
    }
}
