//! Exact nearest-neighbour search in Euclidean distance with lower-bound pruning.

use super::sketch::{BLOCK_LEN, DistanceBounds, N_QUERIES_MAX, QuerySketch, SketchLevel};
use super::view_table::{ViewBlock, ViewTable};
use crate::Metric;
use crate::nearest_categories::NearestList;
use std::ops::Range;
use std::sync::Arc;

/// Number of blocks sorted at once by their lower bound; searching the best first prunes
/// the rest.
const GROUP_LEN: usize = 512;

/// State of a pruned search: queries, bounds and nearest views so far.
struct PrunedSearch<'a, L> {
    queries: &'a [&'a [f32]],
    coarse: QuerySketch,
    fine: QuerySketch,
    bounds: DistanceBounds,
    found: &'a mut L,
    n_compared: usize,
}

/// Exact nearest-neighbour search for one to four queries of an object. Views whose
/// lower bound exceeds the present result are skipped; the distances of the others are
/// computed as in an exhaustive search, so the result is equal bit for bit. Returns the
/// number of compared views.
pub(super) fn search(
    table: &ViewTable,
    blocks: Range<usize>,
    queries: &[&[f32]],
    found: &mut impl NearestList,
) -> usize {
    let first_block = blocks.start;
    let mut search = PrunedSearch {
        queries,
        coarse: QuerySketch::new(queries, SketchLevel::Coarse),
        fine: QuerySketch::new(queries, SketchLevel::Fine),
        bounds: [[0.0; BLOCK_LEN]; N_QUERIES_MAX],
        found,
        n_compared: 0,
    };
    for (group, blocks) in table.blocks()[blocks].chunks(GROUP_LEN).enumerate() {
        search.search_group(blocks, (first_block + group * GROUP_LEN) * BLOCK_LEN);
    }
    search.n_compared
}

impl<L: NearestList> PrunedSearch<'_, L> {
    fn search_group(&mut self, blocks: &[Arc<ViewBlock>], first_row: usize) {
        let mut order = [(f32::INFINITY, 0); GROUP_LEN];
        for (i, block) in blocks.iter().enumerate() {
            if let Some(sketches) = block.sketches() {
                order[i] = (self.coarse.bound(sketches, &mut self.bounds), i);
            }
        }
        let order = &mut order[..blocks.len()];
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(least, i) in &*order {
            if least > self.found.worst_score() {
                return;
            }
            if let Some(sketches) = blocks[i].sketches()
                && self.fine.bound(sketches, &mut self.bounds) <= self.found.worst_score()
            {
                self.search_block(&blocks[i], first_row + i * BLOCK_LEN);
            }
        }
    }

    /// Compares the views of a block that the bounds do not exclude, smallest bound
    /// first.
    fn search_block(&mut self, block: &ViewBlock, first_row: usize) {
        let worst_score = self.found.worst_score();
        let mut promising = [(0.0, 0); BLOCK_LEN];
        let mut n_promising = 0;
        for place in 0..block.views().len() {
            let of_readings = self.bounds.each_ref().map(|bounds| bounds[place]);
            let least = of_readings.into_iter().fold(f32::INFINITY, f32::min);
            if least <= worst_score {
                promising[n_promising] = (least, place);
                n_promising += 1;
            }
        }
        let promising = &mut promising[..n_promising];
        promising.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(least, place) in &*promising {
            if least > self.found.worst_score() {
                return;
            }
            self.compare(block, place, first_row);
        }
    }

    fn compare(&mut self, block: &ViewBlock, place: usize, first_row: usize) {
        let (category, row) = (block.views()[place].category, first_row + place);
        self.n_compared += 1;
        for (query, bounds) in self.queries.iter().zip(&self.bounds) {
            let bound = self.found.bound(category);
            if bounds[place] > bound {
                continue;
            }
            block.offer(row, (Metric::Euclidean, query), bound, self.found);
        }
    }
}

#[cfg(test)]
mod tests;
