//! Minimum and maximum of shadow map blocks, for an early exit of the shadow filter.

use crate::shadow_grid::{BLOCK, MAP_SIDE, N_BLOCKS};

/// Least and greatest reverse-Z depth of all cells that the filter reads at any coordinate of a
/// block. They mostly show that a coordinate is fully lit or fully dark.
#[derive(Debug)]
pub(crate) struct ShadowBounds {
    low: Vec<f32>,
    high: Vec<f32>,
    /// Minimum shadow-map value of each block's own cells.
    own_low: Vec<f32>,
    own_high: Vec<f32>,
}

impl ShadowBounds {
    /// Bounds of an empty shadow map.
    pub(crate) fn new() -> Self {
        let zeros = || vec![0.0; N_BLOCKS * N_BLOCKS];
        Self {
            low: zeros(),
            high: zeros(),
            own_low: zeros(),
            own_high: zeros(),
        }
    }

    /// Computes the bounds of a shadow map.
    pub(crate) fn update(&mut self, reverse_z: &[f32]) {
        reduce(reverse_z, &mut self.own_low, f32::INFINITY, f32::min);
        reduce(reverse_z, &mut self.own_high, 0.0, f32::max);
        spread(&self.own_low, &mut self.low, f32::min);
        spread(&self.own_high, &mut self.high, f32::max);
    }

    /// Conservative bounds, by blocks, of the shadow-map values that the filter reads at a cell.
    #[inline]
    pub(crate) fn around(&self, column: usize, row: usize) -> (f32, f32) {
        let block = row / BLOCK * N_BLOCKS + column / BLOCK;
        (self.low[block], self.high[block])
    }
}

/// Reduces the cells of each block to one value.
#[inline]
fn reduce(cells: &[f32], blocks: &mut [f32], start: f32, combine: impl Fn(f32, f32) -> f32) {
    let rows = cells.chunks_exact(MAP_SIDE * BLOCK);
    for (rows, blocks) in rows.zip(blocks.chunks_exact_mut(N_BLOCKS)) {
        let mut columns = [start; MAP_SIDE];
        for row in rows.chunks_exact(MAP_SIDE) {
            for (column, &cell) in columns.iter_mut().zip(row) {
                *column = combine(*column, cell);
            }
        }
        for (block, columns) in blocks.iter_mut().zip(columns.chunks_exact(BLOCK)) {
            *block = columns.iter().copied().fold(start, &combine);
        }
    }
}

/// Combines each block with its eight neighbours.
#[inline]
fn spread(own: &[f32], around: &mut [f32], combine: impl Fn(f32, f32) -> f32) {
    let row = |row: usize| &own[row * N_BLOCKS..(row + 1) * N_BLOCKS];
    for (y, around) in around.chunks_exact_mut(N_BLOCKS).enumerate() {
        let (above, below) = (row(y.saturating_sub(1)), row((y + 1).min(N_BLOCKS - 1)));
        let mut columns = [0.0; N_BLOCKS];
        for (x, column) in columns.iter_mut().enumerate() {
            *column = combine(combine(above[x], row(y)[x]), below[x]);
        }
        for (x, around) in around.iter_mut().enumerate() {
            let (left, right) = (x.saturating_sub(1), (x + 1).min(N_BLOCKS - 1));
            *around = combine(combine(columns[left], columns[x]), columns[right]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_cover_all_cells_of_the_filter() {
        let hash = |i: usize| (i as u32).wrapping_mul(0x9e37_79b1) >> 8;
        let cells: Vec<f32> = (0..MAP_SIDE * MAP_SIDE).map(|i| hash(i) as f32).collect();
        let mut bounds = ShadowBounds::new();
        bounds.update(&cells);
        for (column, row) in [(1, 1), (5, 1), (100, 203), (380, 380), (7, 379)] {
            let (low, high) = bounds.around(column, row);
            let read = (row - 1..row + 3)
                .flat_map(|row| &cells[row * MAP_SIDE + column - 1..row * MAP_SIDE + column + 3]);
            assert!(read.clone().all(|cell| (low..=high).contains(cell)));
            let (blocks_low, blocks_high) = brute_force(&cells, column / BLOCK, row / BLOCK);
            assert_eq!((low, high), (blocks_low, blocks_high));
        }
    }

    /// Brute-force reference: minimum and maximum of a block and its neighbours.
    fn brute_force(cells: &[f32], column: usize, row: usize) -> (f32, f32) {
        let near = |a: usize, b: usize| (a / BLOCK).abs_diff(b) <= 1;
        (0..MAP_SIDE * MAP_SIDE)
            .filter(|i| near(i % MAP_SIDE, column) && near(i / MAP_SIDE, row))
            .map(|i| cells[i])
            .fold((f32::INFINITY, 0.0), |(low, high), cell| {
                (low.min(cell), high.max(cell))
            })
    }
}
