//! Depth buffer of labelled points, closed so that a surface of points has no holes.
//!
//! A cell is one number: quantised depth above the label of the point, so that the least number is
//! the nearest point. Splatting every point over 3x3 cells is then a minimum filter over the
//! cells. The maximum filter after it takes back by what the splats have widened the outlines;
//! together they are a morphological closing, which fills holes and keeps outlines.
//!
//! A cell that holds any point of a surface is taken as full, so that outlines are half a cell too
//! wide on all sides. Areas are therefore counted in the squares between the middles of four
//! cells, of which each belongs to the farthest of the four.

use crate::view_projection::{CellGrid, CellMapping, DEPTH_STEPS};

/// Empty cell: behind everything.
pub(crate) const EMPTY: i32 = i32::MAX;

/// Bits of the label below the depth.
const LABEL_BITS: u32 = 16;

/// Number of points mapped at once.
const BLOCK: usize = 128;

/// Number whose addition leaves the nearest integer in the low bits of the sum, for numbers from 0
/// to 2^22.
const ROUNDER: f32 = 8_388_608.0;

/// Low bits of a sum with [`ROUNDER`].
const ROUNDER_MASK: u32 = 0x007f_ffff;

/// Coordinates of points as one slice for each axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointSlices<'a> {
    pub(crate) x: &'a [f32],
    pub(crate) y: &'a [f32],
    pub(crate) z: &'a [f32],
}

/// Cells of a view with margins.
#[derive(Debug, Clone, Default)]
pub(crate) struct DepthBuffer {
    /// Nearest point of each cell.
    drawn: Vec<i32>,
    /// Closed cells; the result.
    closed: Vec<i32>,
    scratch: Vec<i32>,
}

impl DepthBuffer {
    /// Empties all cells of a grid.
    pub(crate) fn clear(&mut self, grid: &CellGrid) {
        let n_cells = grid.stride() * grid.n_rows();
        for cells in [&mut self.drawn, &mut self.closed, &mut self.scratch] {
            cells.resize(n_cells, EMPTY);
        }
        self.drawn.fill(EMPTY);
    }

    /// Cells after [`close`](Self::close): depth steps and label, or [`EMPTY`].
    pub(crate) fn cells(&self) -> &[i32] {
        &self.closed
    }

    /// Squares between each cell, the next one, and those below them, after
    /// [`close`](Self::close), by the index of the first cell.
    pub(crate) fn squares(&self) -> &[i32] {
        &self.scratch
    }

    /// Draws points with a label.
    pub(crate) fn draw(&mut self, points: PointSlices<'_>, label: u16, mapping: &CellMapping) {
        let xs = points.x.chunks(BLOCK);
        for ((x, y), z) in xs.zip(points.y.chunks(BLOCK)).zip(points.z.chunks(BLOCK)) {
            let block = PointSlices { x, y, z };
            let mut cells = [0_u32; BLOCK];
            let mut keys = [0_i32; BLOCK];
            match mapping.pinhole {
                None => map_orthographic(block, mapping, &mut cells, &mut keys),
                Some(pinhole) => map_perspective(block, mapping, pinhole, &mut cells, &mut keys),
            }
            for (cell, key) in cells.iter().zip(&keys).take(x.len()) {
                if let Some(nearest) = self.drawn.get_mut(*cell as usize) {
                    *nearest = (*nearest).min(key | i32::from(label));
                }
            }
        }
    }

    /// Closes the drawn cells by squares of `2 radius + 1` cells. A drawn point that is at most
    /// `tolerance_steps` behind the closed surface keeps its cell.
    pub(crate) fn close(&mut self, grid: &CellGrid, radius: usize, tolerance_steps: i32) {
        let stride = grid.stride();
        self.closed.copy_from_slice(&self.drawn);
        for _ in 0..radius {
            filter(&mut self.closed, &mut self.scratch, stride, i32::min);
        }
        for _ in 0..radius {
            filter(&mut self.closed, &mut self.scratch, stride, i32::max);
        }
        let tolerance = tolerance_steps << LABEL_BITS;
        for (closed, drawn) in self.closed.iter_mut().zip(&self.drawn) {
            // Both numbers are not negative, so the difference does not overflow.
            let is_visible = *drawn != EMPTY && drawn - *closed <= tolerance;
            *closed = if is_visible { *drawn } else { *closed };
        }
        farthest_of_four(&self.closed, &mut self.scratch, stride);
    }
}

/// Label of a cell that is not empty.
#[inline]
pub(crate) fn label_of(cell: i32) -> u16 {
    cell as u16
}

/// Depth of a cell that is not empty, steps.
#[inline]
pub(crate) fn steps_of(cell: i32) -> i32 {
    cell >> LABEL_BITS
}

/// Value of an affine row at a point.
#[inline]
fn affine(row: &[f32; 4], x: f32, y: f32, z: f32) -> f32 {
    row[0] * x + row[1] * y + (row[2] * z + row[3])
}

/// Nearest integer of a number from 0 to 2^22.
#[inline]
fn rounded(value: f32) -> u32 {
    (value + ROUNDER).to_bits() & ROUNDER_MASK
}

/// Depth in the upper bits of a key; empty in front of the first step.
#[inline]
fn depth_key(steps: f32) -> i32 {
    let key = (rounded(steps.clamp(0.0, DEPTH_STEPS)) << LABEL_BITS) as i32;
    if steps >= 0.0 { key } else { EMPTY }
}

fn map_orthographic(
    points: PointSlices<'_>,
    mapping: &CellMapping,
    cells: &mut [u32; BLOCK],
    keys: &mut [i32; BLOCK],
) {
    let [columns, rows, steps] = &mapping.rows;
    let stride = mapping.grid.stride() as u32;
    let targets = cells.iter_mut().zip(keys);
    let sources = points.x.iter().zip(points.y).zip(points.z);
    for ((cell, key), ((x, y), z)) in targets.zip(sources) {
        // The grid encloses all points, so that columns and rows are within it.
        let column = rounded(affine(columns, *x, *y, *z));
        let row = rounded(affine(rows, *x, *y, *z));
        *cell = row.wrapping_mul(stride).wrapping_add(column);
        *key = depth_key(affine(steps, *x, *y, *z));
    }
}

/// Points outside of the margins go to the outermost ring of cells, which closing does not carry
/// as far as the image.
fn map_perspective(
    points: PointSlices<'_>,
    mapping: &CellMapping,
    [fx, fy, cx, cy]: [f32; 4],
    cells: &mut [u32; BLOCK],
    keys: &mut [i32; BLOCK],
) {
    let [across, down, steps] = &mapping.rows;
    let grid = &mapping.grid;
    let last = [grid.stride() as f32 - 1.0, grid.n_rows() as f32 - 1.0];
    let stride = grid.stride() as u32;
    let targets = cells.iter_mut().zip(keys);
    let sources = points.x.iter().zip(points.y).zip(points.z);
    for ((cell, key), ((x, y), z)) in targets.zip(sources) {
        let depth_steps = affine(steps, *x, *y, *z);
        let inverse = 1.0 / (mapping.first_m + depth_steps * mapping.step_m);
        let column = (affine(across, *x, *y, *z) * inverse * fx + cx).clamp(0.0, last[0]);
        let row = (affine(down, *x, *y, *z) * inverse * fy + cy).clamp(0.0, last[1]);
        *cell = rounded(row)
            .wrapping_mul(stride)
            .wrapping_add(rounded(column));
        *key = depth_key(depth_steps);
    }
}

/// Filter of 3x3 cells in place; the outermost rows of cells become empty.
#[inline]
fn filter(
    cells: &mut [i32],
    scratch: &mut [i32],
    stride: usize,
    of: impl Fn(i32, i32) -> i32 + Copy,
) {
    let n = cells.len();
    if n < 2 * stride + 2 {
        return;
    }
    // Along rows; the ends of neighbouring rows meet in the margins, which stay apart from the
    // image.
    let triples = cells.iter().zip(&cells[1..]).zip(&cells[2..]);
    for (target, ((left, middle), right)) in scratch[1..n - 1].iter_mut().zip(triples) {
        *target = of(of(*left, *middle), *right);
    }
    scratch[0] = EMPTY;
    scratch[n - 1] = EMPTY;
    let triples = scratch
        .iter()
        .zip(&scratch[stride..])
        .zip(&scratch[2 * stride..]);
    for (target, ((above, middle), below)) in cells[stride..n - stride].iter_mut().zip(triples) {
        *target = of(of(*above, *middle), *below);
    }
    cells[..stride].fill(EMPTY);
    cells[n - stride..].fill(EMPTY);
}

/// Farthest of each cell, the next one, and those below them.
fn farthest_of_four(cells: &[i32], squares: &mut [i32], stride: usize) {
    let n = cells.len();
    if n < stride + 2 {
        squares.fill(EMPTY);
        return;
    }
    let above = cells.iter().zip(&cells[1..]);
    let below = cells[stride..].iter().zip(&cells[stride + 1..]);
    for (square, ((a, b), (c, d))) in squares.iter_mut().zip(above.zip(below)) {
        *square = (*a).max(*b).max((*c).max(*d));
    }
    squares[n - stride - 1..].fill(EMPTY);
}
