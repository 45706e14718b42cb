//! Ray evidence: per cell of the table's plane, what the rays of the camera tell about it.

use super::cell_grid::CellGrid;
use crate::affine_form::AffineForm;
use crate::samples::Samples;
use crate::table::Table;

/// Least depth below the plane of a sample that is seen through it, metres. Chosen.
const SEEN_THROUGH_M: f32 = 0.03;

/// Greatest distance from the plane of a sample level with the table, metres. Chosen.
const LEVEL_M: f32 = 0.015;

/// Greatest depth below the plane at which a surface counts as passing through it, metres.
/// Chosen.
const BELOW_M: f32 = 0.10;

/// Number of samples per cell, by what they show. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct RayEvidence {
    /// Samples seen through the cell: the plane is free there.
    pub(crate) n_through: Vec<u8>,
    /// Samples whose ray would reach the cell behind something above the plane.
    pub(crate) n_occluded: Vec<u8>,
    /// Samples level with the table in the cell.
    pub(crate) n_level: Vec<u16>,
    /// Samples right above the cell.
    pub(crate) n_above: Vec<u16>,
    /// Samples right below the cell.
    pub(crate) n_below: Vec<u16>,
}

impl RayEvidence {
    /// Count the samples of an image.
    pub(crate) fn refill(&mut self, grid: &CellGrid, table: &Table, samples: &Samples) {
        self.clear(grid.len());
        let [u, v, height] = AffineForm::coordinates_of(&table.table_from_camera);
        let camera = [&u, &v, &height].map(|axis| axis.at(0.0, 0.0, 0.0));
        for sample in (0..samples.len()).filter(|&sample| samples.depth(sample) > 0.0) {
            let at = [&u, &v].map(|axis| samples.coordinate(axis, sample));
            let above = samples.coordinate(&height, sample);
            if above >= -BELOW_M
                && let Some(cell) = grid.cell_of(at[0], at[1])
            {
                self.count_at(cell, above);
            }
            let is_crossing = !(-SEEN_THROUGH_M..=LEVEL_M).contains(&above);
            if is_crossing && above < camera[2] {
                // Intersection of the plane with the ray from the camera through the sample.
                let share = camera[2] / (camera[2] - above);
                let [u, v] = [0, 1].map(|i| camera[i] + share * (at[i] - camera[i]));
                if let Some(cell) = grid.cell_of(u, v) {
                    let counts = if above < 0.0 {
                        &mut self.n_through
                    } else {
                        &mut self.n_occluded
                    };
                    counts[cell] = counts[cell].saturating_add(1);
                }
            }
        }
    }

    /// Empty evidence for `n_cells` cells.
    fn clear(&mut self, n_cells: usize) {
        for counts in [&mut self.n_through, &mut self.n_occluded] {
            counts.clear();
            counts.resize(n_cells, 0);
        }
        for counts in [&mut self.n_level, &mut self.n_above, &mut self.n_below] {
            counts.clear();
            counts.resize(n_cells, 0);
        }
    }

    /// Count a sample straight above, at or below a cell.
    fn count_at(&mut self, cell: usize, above: f32) {
        let counts = if above > LEVEL_M {
            &mut self.n_above
        } else if above >= -LEVEL_M {
            &mut self.n_level
        } else if above < -SEEN_THROUGH_M {
            &mut self.n_below
        } else {
            return;
        };
        counts[cell] = counts[cell].saturating_add(1);
    }
}
