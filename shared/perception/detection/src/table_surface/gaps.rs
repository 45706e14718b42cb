//! Gaps of the table inside its polygon, for example the missing corner of an L shape.

use super::cell_grid::CellGrid;
use super::ray_evidence::RayEvidence;

/// Least number of samples seen through a cell that proves a gap. Chosen.
pub(super) const THROUGH_SAMPLES_MIN: u8 = 2;

/// Least number of samples right below and right above a cell that prove an object from the
/// floor passing through it. Chosen.
const PIERCING_SAMPLES_MIN: i32 = 2;

/// Least total area of gaps, square metres; smaller ones are noise. Chosen.
const GAP_AREA_MIN_M2: f64 = 0.01;

/// Gaps found last, with buffers.
#[derive(Debug, Default)]
pub(super) struct TableGaps {
    is_gap: Vec<bool>,
    is_known: Vec<bool>,
    front: Vec<u32>,
    scratch: Vec<bool>,
}

impl TableGaps {
    /// Forget all gaps.
    pub(super) fn clear(&mut self) {
        self.is_gap.clear();
    }

    /// `true` when the table has gaps.
    pub(super) fn is_any(&self) -> bool {
        self.is_gap.contains(&true)
    }

    /// Find the gaps and remove them from the table, with the cells occluded by objects that
    /// reach up through a gap.
    pub(super) fn cut(&mut self, grid: &CellGrid, rays: &RayEvidence, is_table: &mut [bool]) {
        self.find(grid, rays, is_table);
        if self.is_any() {
            self.grow(grid, rays, is_table);
        }
        for (is_table, is_gap) in is_table.iter_mut().zip(&self.is_gap) {
            *is_table &= !is_gap;
        }
        if self.is_any() {
            self.keep_largest_component(grid, is_table);
        }
    }

    /// Keep the largest connected component of the table. Beyond a gap the plane cuts through
    /// something else, such as the back of a chair.
    fn keep_largest_component(&mut self, grid: &CellGrid, is_table: &mut [bool]) {
        let Self {
            is_known: is_visited,
            front,
            ..
        } = self;
        is_visited.clear();
        is_visited.resize(is_table.len(), false);
        // Components one after the other in `front`; the largest so far as a range of it.
        front.clear();
        let mut largest = 0..0;
        for start in 0..is_table.len() {
            if !is_table[start] || is_visited[start] {
                continue;
            }
            let first = front.len();
            is_visited[start] = true;
            front.push(start as u32);
            let mut next = first;
            while let Some(&cell) = front.get(next) {
                next += 1;
                for near in grid.neighbours(cell as usize) {
                    if is_table.get(near) == Some(&true) && !is_visited[near] {
                        is_visited[near] = true;
                        front.push(near as u32);
                    }
                }
            }
            if front.len() - first > largest.len() {
                largest = first..front.len();
            }
        }
        is_table.fill(false);
        for &cell in &front[largest] {
            is_table[cell as usize] = true;
        }
    }

    /// Find the gaps by morphological opening of the see-through cells; too small a total
    /// area is noise.
    fn find(&mut self, grid: &CellGrid, rays: &RayEvidence, is_table: &[bool]) {
        let Self {
            is_gap,
            is_known: closed,
            scratch,
            ..
        } = self;
        let not_through = rays.n_through.iter().map(|&n| n < THROUGH_SAMPLES_MIN);
        closed.clear();
        closed.extend(not_through);
        // Opening: dilate the complement by a cell, then dilate the remaining gaps back.
        grid.dilate(closed, 1, scratch, is_gap);
        for cell in is_gap.iter_mut() {
            *cell = !*cell;
        }
        grid.dilate(is_gap, 1, scratch, closed);
        std::mem::swap(closed, is_gap);
        for (is_gap, is_table) in is_gap.iter_mut().zip(is_table) {
            *is_gap &= is_table;
        }
        let n_gaps = is_gap.iter().filter(|&&is_gap| is_gap).count();
        if (n_gaps as f64) * grid.cell_m().powi(2) < GAP_AREA_MIN_M2 {
            is_gap.fill(false);
        }
    }

    /// Assign each occluded cell to the nearest known one: visible table or an object
    /// passing through.
    fn grow(&mut self, grid: &CellGrid, rays: &RayEvidence, is_table: &[bool]) {
        let Self {
            front,
            is_known,
            is_gap,
            ..
        } = self;
        front.clear();
        is_known.clear();
        for (cell, is_gap) in is_gap.iter_mut().enumerate() {
            let is_table = is_table[cell];
            let n_level = i32::from(rays.n_level[cell]) - i32::from(rays.n_above[cell]);
            let is_pierced = is_table
                && n_level <= -PIERCING_SAMPLES_MIN
                && i32::from(rays.n_below[cell]) >= PIERCING_SAMPLES_MIN;
            let is_source = is_pierced || is_table && n_level > 0 && !*is_gap;
            *is_gap |= is_pierced;
            is_known.push(is_source || *is_gap || !is_table);
            if is_source {
                front.push(cell as u32);
            }
        }
        let mut next = 0;
        while let Some(&cell) = front.get(next) {
            next += 1;
            let cell = cell as usize;
            for near in grid.neighbours(cell) {
                if is_known.get(near) == Some(&false) {
                    is_known[near] = true;
                    is_gap[near] = is_gap[cell];
                    front.push(near as u32);
                }
            }
        }
    }
}
