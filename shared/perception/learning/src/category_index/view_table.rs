//! The taught views in pieces that copies of an index share.

use super::sketch::SketchBlock;
use crate::nearest_categories::{Candidate, NearestCategories};
use crate::{CategoryName, Metric, ViewId};
use std::sync::Arc;

/// Views of a block.
pub(super) const BLOCK: usize = 64;

/// What is known of a view besides its descriptor.
#[derive(Debug, Clone)]
pub(super) struct IndexedView {
    pub(super) id: ViewId,
    pub(super) name: CategoryName,
    /// Number of the category.
    pub(super) category: u64,
}

/// Views by row, without gaps. A copy shares all blocks; a block is copied when
/// one of its views changes while a copy holds it.
#[derive(Debug, Clone)]
pub(super) struct ViewTable {
    dimension: usize,
    has_sketches: bool,
    n_views: usize,
    blocks: Vec<Arc<ViewBlock>>,
}

/// Up to [`BLOCK`] views; only the last block of a table has fewer.
#[derive(Debug, Clone)]
pub(super) struct ViewBlock {
    dimension: usize,
    views: Vec<IndexedView>,
    /// A row for each view.
    descriptors: Vec<f32>,
    sketches: Option<SketchBlock>,
}

impl ViewTable {
    /// A table for descriptors of `dimension` values, with or without sketches.
    pub(super) fn new(dimension: usize, has_sketches: bool) -> Self {
        Self {
            dimension,
            has_sketches,
            n_views: 0,
            blocks: Vec::new(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.n_views
    }

    /// All blocks; the row of a view is [`BLOCK`] times its block, and its place there.
    pub(super) fn blocks(&self) -> &[Arc<ViewBlock>] {
        &self.blocks
    }

    pub(super) fn view(&self, row: usize) -> &IndexedView {
        &self.blocks[row / BLOCK].views[row % BLOCK]
    }

    pub(super) fn view_mut(&mut self, row: usize) -> &mut IndexedView {
        &mut Arc::make_mut(&mut self.blocks[row / BLOCK]).views[row % BLOCK]
    }

    pub(super) fn descriptor(&self, row: usize) -> &[f32] {
        self.blocks[row / BLOCK].descriptor(row % BLOCK)
    }

    /// Replaces the descriptor of a view.
    pub(super) fn describe(&mut self, row: usize, descriptor: &[f32]) {
        Arc::make_mut(&mut self.blocks[row / BLOCK]).describe(row % BLOCK, descriptor);
    }

    /// Adds a view behind the last row.
    pub(super) fn push(&mut self, view: IndexedView, descriptor: &[f32]) {
        if self.n_views == self.blocks.len() * BLOCK {
            let block = ViewBlock::new(self.dimension, self.has_sketches);
            self.blocks.push(Arc::new(block));
        }
        if let Some(block) = self.blocks.last_mut() {
            Arc::make_mut(block).push(view, descriptor);
            self.n_views += 1;
        }
    }

    /// Removes a view; the last one takes its row.
    pub(super) fn swap_remove(&mut self, row: usize) -> Option<IndexedView> {
        let block = Arc::make_mut(self.blocks.last_mut()?);
        let (last, descriptor) = block.pop()?;
        if block.views.is_empty() {
            self.blocks.pop();
        }
        self.n_views -= 1;
        if row == self.n_views {
            return Some(last);
        }
        self.describe(row, &descriptor);
        Some(std::mem::replace(self.view_mut(row), last))
    }

    /// Removes all views.
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.n_views = 0;
    }
}

impl ViewBlock {
    fn new(dimension: usize, has_sketches: bool) -> Self {
        Self {
            dimension,
            views: Vec::with_capacity(BLOCK),
            descriptors: Vec::with_capacity(BLOCK * dimension),
            sketches: has_sketches.then(SketchBlock::new),
        }
    }

    pub(super) fn views(&self) -> &[IndexedView] {
        &self.views
    }

    pub(super) fn descriptor(&self, place: usize) -> &[f32] {
        &self.descriptors[place * self.dimension..][..self.dimension]
    }

    pub(super) fn sketches(&self) -> Option<&SketchBlock> {
        self.sketches.as_ref()
    }

    /// Offers the view of a row in one reading; says whether it became the nearest of
    /// its category, which it can with a score up to `bound` only.
    #[inline]
    pub(super) fn offer(
        &self,
        row: usize,
        (metric, reading): (Metric, &[f32]),
        bound: f32,
        found: &mut NearestCategories,
    ) -> bool {
        let view = &self.views[row % BLOCK];
        let score = metric.bounded_score(reading, self.descriptor(row % BLOCK), bound);
        score.is_some_and(|score| {
            found.offer(Candidate {
                score,
                view: view.id,
                category: view.category,
                row,
            })
        })
    }

    fn describe(&mut self, place: usize, descriptor: &[f32]) {
        self.descriptors[place * self.dimension..][..self.dimension].copy_from_slice(descriptor);
        if let Some(sketches) = &mut self.sketches {
            sketches.set(place, descriptor);
        }
    }

    fn push(&mut self, view: IndexedView, descriptor: &[f32]) {
        if let Some(sketches) = &mut self.sketches {
            sketches.set(self.views.len(), descriptor);
        }
        self.views.push(view);
        self.descriptors.extend_from_slice(descriptor);
    }

    fn pop(&mut self) -> Option<(IndexedView, Vec<f32>)> {
        let view = self.views.pop()?;
        if let Some(sketches) = &mut self.sketches {
            sketches.clear(self.views.len());
        }
        let descriptor = self
            .descriptors
            .split_off(self.views.len() * self.dimension);
        Some((view, descriptor))
    }
}
