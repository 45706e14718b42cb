//! Cell grid over the table: cell lookup and morphology.

use geometry::ConvexPolygon;
use nalgebra::Point2;

/// Cell size, metres; a larger table gets larger cells. Chosen.
const CELL_M: f64 = 0.02;

/// Greatest number of cells per side.
const CELLS_MAX: usize = 256;

/// Least number of which the next one in single precision is larger by 1. There are fewer cells.
const TWO_TO_23: f32 = 8_388_608.0;

/// Bits of the mantissa in single precision.
const MANTISSA: u32 = (1 << 23) - 1;

/// Cell number of a point outside of the grid.
const OUTSIDE: u32 = u32::MAX;

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
    pub(crate) fn cell_of(&self, u: f32, v: f32) -> Option<usize> {
        let index = self.index_of(u, v);
        (index != OUTSIDE).then_some(index as usize)
    }

    /// Cell of a point in the table's frame; outside of the grid a number larger than all
    /// cells. In 32 bits, so that the compiler vectorises it.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "unpredictable branches cost more than comparisons"
    )]
    pub(crate) fn index_of(&self, u: f32, v: f32) -> u32 {
        let column = (u - self.u_min) * self.cells_per_m;
        let row = (v - self.v_min) * self.cells_per_m;
        let inside = (column >= 0.0)
            & (row >= 0.0)
            & (column < self.width as f32)
            & (row < self.height as f32);
        // An integer below 2²³, added to 2²³, is the mantissa. A cast would saturate, which the
        // compiler does not vectorise.
        let index = row.floor() * self.width as f32 + column.floor();
        let index = (index + TWO_TO_23).to_bits() & MANTISSA;
        if inside { index } else { OUTSIDE }
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
        scratch.clear();
        scratch.extend_from_slice(marked);
        let width = self.width.max(1);
        let lines = marked.chunks_exact(width);
        for (line, dilated) in lines.zip(scratch.chunks_exact_mut(width)) {
            mark_shifted(line, reach.min(width), 1, dilated);
        }
        dilated.clear();
        dilated.extend_from_slice(scratch);
        mark_shifted(scratch, reach.min(self.height), width, dilated);
    }
}

/// Dilation along one direction: mark the cells up to `reach` strides of `stride` cells before
/// and after each marked one. Whole slices at a time, so that the compiler vectorises it.
fn mark_shifted(marked: &[bool], reach: usize, stride: usize, dilated: &mut [bool]) {
    for step in 1..=reach {
        let shift = step * stride;
        let n = marked.len() - shift;
        mark_all(&mut dilated[shift..], &marked[..n]);
        mark_all(&mut dilated[..n], &marked[shift..]);
    }
}

/// Mark the cells that are marked in another slice.
fn mark_all(marked: &mut [bool], others: &[bool]) {
    for (marked, &other) in marked.iter_mut().zip(others) {
        *marked |= other;
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
