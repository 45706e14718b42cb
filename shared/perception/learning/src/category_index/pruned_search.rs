//! The nearest views by Euclidean distance, most of them never compared in full.

use super::sketch::{Bounds, Level, N_TOGETHER, QuerySketch};
use super::view_table::{BLOCK, ViewBlock, ViewTable};
use crate::Metric;
use crate::nearest_categories::NearestCategories;
use std::ops::Range;
use std::sync::Arc;

/// Blocks that are put in order at once, the most promising first, so that the
/// others have little left to offer.
const GROUP: usize = 512;

/// The readings that are compared, and the nearest views so far.
struct Search<'a, F> {
    readings: &'a [&'a [f32]],
    coarse: QuerySketch,
    fine: QuerySketch,
    bounds: Bounds,
    found: &'a mut NearestCategories,
    on_nearer: F,
    n_compared: usize,
}

/// Offers what is nearest to one to four readings of an object, as a comparison of
/// all pairs with [`Metric::Euclidean`] does, to the bit: lower bounds decide which
/// views of the blocks are compared, their distance is computed as always. Tells the row
/// of each view that is the nearest of its category so far, and returns how many views
/// were compared.
pub(super) fn search(
    table: &ViewTable,
    blocks: Range<usize>,
    readings: &[&[f32]],
    found: &mut NearestCategories,
    on_nearer: impl FnMut(usize),
) -> usize {
    let first_block = blocks.start;
    let mut search = Search {
        readings,
        coarse: QuerySketch::new(readings, Level::Coarse),
        fine: QuerySketch::new(readings, Level::Fine),
        bounds: [[0.0; BLOCK]; N_TOGETHER],
        found,
        on_nearer,
        n_compared: 0,
    };
    for (group, blocks) in table.blocks()[blocks].chunks(GROUP).enumerate() {
        search.look_at_group(blocks, (first_block + group * GROUP) * BLOCK);
    }
    search.n_compared
}

impl<F: FnMut(usize)> Search<'_, F> {
    fn look_at_group(&mut self, blocks: &[Arc<ViewBlock>], first_row: usize) {
        let mut order = [(f32::INFINITY, 0); GROUP];
        for (i, block) in blocks.iter().enumerate() {
            if let Some(sketches) = block.sketches() {
                order[i] = (self.coarse.bound(sketches, &mut self.bounds), i);
            }
        }
        let order = &mut order[..blocks.len()];
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(least, i) in &*order {
            if least > self.found.farthest() {
                return;
            }
            if let Some(sketches) = blocks[i].sketches()
                && self.fine.bound(sketches, &mut self.bounds) <= self.found.farthest()
            {
                self.look_at_block(&blocks[i], first_row + i * BLOCK);
            }
        }
    }

    /// Compares the views of a block that may be near enough, the most promising
    /// first.
    fn look_at_block(&mut self, block: &ViewBlock, first_row: usize) {
        let farthest = self.found.farthest();
        let mut promising = [(0.0, 0); BLOCK];
        let mut n_promising = 0;
        for place in 0..block.views().len() {
            let of_readings = self.bounds.each_ref().map(|bounds| bounds[place]);
            let least = of_readings.into_iter().fold(f32::INFINITY, f32::min);
            if least <= farthest {
                promising[n_promising] = (least, place);
                n_promising += 1;
            }
        }
        let promising = &mut promising[..n_promising];
        promising.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(least, place) in &*promising {
            if least > self.found.farthest() {
                return;
            }
            self.compare(block, place, first_row);
        }
    }

    fn compare(&mut self, block: &ViewBlock, place: usize, first_row: usize) {
        let (category, row) = (block.views()[place].category, first_row + place);
        self.n_compared += 1;
        for (reading, bounds) in self.readings.iter().zip(&self.bounds) {
            let bound = self.found.bound(category);
            if bounds[place] > bound {
                continue;
            }
            if block.offer(row, (Metric::Euclidean, reading), bound, self.found) {
                (self.on_nearer)(row);
            }
        }
    }
}
