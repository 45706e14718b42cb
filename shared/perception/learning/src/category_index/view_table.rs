//! Table of taught views in copy-on-write blocks.

use super::sketch::{BLOCK_LEN, SketchBlock};
use crate::nearest_categories::{NearestList, ScoredView};
use crate::{CategoryName, Metric, ViewId};
use std::sync::Arc;

/// Id and category of a view.
#[derive(Debug, Clone)]
pub(super) struct IndexedView {
    pub(super) id: ViewId,
    pub(super) name: CategoryName,
    /// Category number of the view.
    pub(super) category: u64,
}

/// Views by row, without gaps. Clones share the blocks; a shared block is copied when
/// one of its views changes.
#[derive(Debug, Clone)]
pub(super) struct ViewTable {
    dimension: usize,
    has_sketches: bool,
    n_views: usize,
    blocks: Vec<Arc<ViewBlock>>,
}

/// Block of up to [`BLOCK_LEN`] views; only the last one of a table has fewer.
#[derive(Debug, Clone)]
pub(super) struct ViewBlock {
    dimension: usize,
    views: Vec<IndexedView>,
    /// Descriptors of the views, row-major, one row per view.
    descriptors: Vec<f32>,
    sketches: Option<SketchBlock>,
}

impl ViewTable {
    /// Empty table for descriptors of `dimension` values, with or without sketches.
    pub(super) fn new(dimension: usize, has_sketches: bool) -> Self {
        Self {
            dimension,
            has_sketches,
            n_views: 0,
            blocks: Vec::new(),
        }
    }

    /// Length of the descriptors, values.
    pub(super) fn dimension(&self) -> usize {
        self.dimension
    }

    pub(super) fn len(&self) -> usize {
        self.n_views
    }

    /// Blocks; the row of a view is [`BLOCK_LEN`] times its block, plus its slot there.
    pub(super) fn blocks(&self) -> &[Arc<ViewBlock>] {
        &self.blocks
    }

    pub(super) fn view(&self, row: usize) -> &IndexedView {
        &self.blocks[row / BLOCK_LEN].views[row % BLOCK_LEN]
    }

    pub(super) fn view_mut(&mut self, row: usize) -> &mut IndexedView {
        &mut Arc::make_mut(&mut self.blocks[row / BLOCK_LEN]).views[row % BLOCK_LEN]
    }

    pub(super) fn descriptor(&self, row: usize) -> &[f32] {
        self.blocks[row / BLOCK_LEN].descriptor(row % BLOCK_LEN)
    }

    /// Replaces the descriptor of a view.
    pub(super) fn describe(&mut self, row: usize, descriptor: &[f32]) {
        Arc::make_mut(&mut self.blocks[row / BLOCK_LEN]).describe(row % BLOCK_LEN, descriptor);
    }

    /// Appends a view to the table.
    pub(super) fn push(&mut self, view: IndexedView, descriptor: &[f32]) {
        if self.n_views == self.blocks.len() * BLOCK_LEN {
            let block = ViewBlock::new(self.dimension, self.has_sketches);
            self.blocks.push(Arc::new(block));
        }
        if let Some(block) = self.blocks.last_mut() {
            Arc::make_mut(block).push(view, descriptor);
            self.n_views += 1;
        }
    }

    /// Removes a view from the table; the last view takes its row.
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

    /// Removes all views from the table.
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.n_views = 0;
    }
}

impl ViewBlock {
    fn new(dimension: usize, has_sketches: bool) -> Self {
        Self {
            dimension,
            views: Vec::with_capacity(BLOCK_LEN),
            descriptors: Vec::with_capacity(BLOCK_LEN * dimension),
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

    /// Compares a query with the view of a row and offers it to the result unless its
    /// score exceeds `bound`.
    #[inline]
    pub(super) fn offer(
        &self,
        row: usize,
        (metric, query): (Metric, &[f32]),
        bound: f32,
        found: &mut impl NearestList,
    ) {
        let view = &self.views[row % BLOCK_LEN];
        let score = metric.bounded_score(query, self.descriptor(row % BLOCK_LEN), bound);
        if let Some(score) = score {
            found.offer(ScoredView {
                score,
                view: view.id,
                category: view.category,
                row,
            });
        }
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
