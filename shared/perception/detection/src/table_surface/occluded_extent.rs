//! Occluded extent: the table goes on behind the objects that hide it, up to free space and
//! up to its rim.

use super::cell_grid::CellGrid;
use super::gaps::THROUGH_SAMPLES_MIN;
use super::ray_evidence::RayEvidence;
use crate::outline::Outline;
use nalgebra::{Point2, Vector2};

/// Greatest distance of the extended table from its visible part, metres: the occlusion
/// shadow of an object of 30 cm under a camera that looks down by 30 degrees. Chosen.
pub(super) const EXTENT_MAX_M: f64 = 0.5;

/// Least length of a rim side that limits the table beyond its ends, metres. Chosen.
const RIM_LENGTH_MIN_M: f64 = 0.15;

/// Least area of the occluded cells of the extent, square metres; a smaller one is the noise
/// of the border. Chosen.
const AREA_MIN_M2: f64 = 0.01;

/// Occluded extent found last, with buffers.
#[derive(Debug, Default)]
pub(super) struct OccludedExtent {
    /// Half planes of the rim: a point on the border and the outward normal.
    rims: Vec<(Point2<f64>, Vector2<f64>)>,
    front: Vec<u32>,
    /// Added cells.
    added: Vec<u32>,
}

impl OccludedExtent {
    /// Forget the extent.
    pub(super) fn clear(&mut self) {
        self.added.clear();
    }

    /// `true` when the table was extended.
    pub(super) fn is_any(&self) -> bool {
        !self.added.is_empty()
    }

    /// Extend the table over the connected cells that something above the plane hides, and
    /// over its visible cells behind them. A cell that is seen through is free, and a cell
    /// beyond a rim of the convex `hull` is not table.
    pub(super) fn grow(
        &mut self,
        grid: &CellGrid,
        rays: &RayEvidence,
        hull: &Outline,
        is_table: &mut [bool],
    ) {
        self.clear();
        self.list_rims(hull);
        self.front.clear();
        self.front
            .extend((0..is_table.len() as u32).filter(|&cell| is_table[cell as usize]));
        let mut next = 0;
        while let Some(&cell) = self.front.get(next) {
            next += 1;
            for near in grid.neighbours(cell as usize) {
                let is_new = is_table.get(near) == Some(&false);
                if is_new && may_be_table(rays, near) && self.is_within_rims(&grid.centre(near)) {
                    is_table[near] = true;
                    self.front.push(near as u32);
                    self.added.push(near as u32);
                }
            }
        }
        let is_occluded = |&&cell: &&u32| rays.n_level[cell as usize] == 0;
        let n_occluded = self.added.iter().filter(is_occluded).count();
        if (n_occluded as f64) * grid.cell_m().powi(2) < AREA_MIN_M2 {
            for cell in self.added.drain(..) {
                is_table[cell as usize] = false;
            }
        }
    }

    /// List the half planes of the rim sides that are long enough to have a direction.
    fn list_rims(&mut self, hull: &Outline) {
        self.rims.clear();
        for (a, b, is_rim) in hull.sides() {
            let along = b - a;
            let length_m = along.norm();
            if is_rim && length_m >= RIM_LENGTH_MIN_M {
                self.rims
                    .push((a, Vector2::new(along.y, -along.x) / length_m));
            }
        }
    }

    /// `true` when a place is inside all half planes of the rim.
    fn is_within_rims(&self, place: &Point2<f64>) -> bool {
        let mut rims = self.rims.iter();
        rims.all(|(on_rim, outward)| (place - on_rim).dot(outward) <= 0.0)
    }
}

/// `true` when a cell is hidden or level with the table, and not free.
fn may_be_table(rays: &RayEvidence, cell: usize) -> bool {
    rays.n_through[cell] < THROUGH_SAMPLES_MIN
        && (rays.n_occluded[cell] > 0 || rays.n_level[cell] > 0)
}
