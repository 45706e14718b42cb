//! Incremental recognition of a tracked object with a cache of its nearest views.

use super::pruned_search::search;
use super::sketch::{BLOCK_LEN, N_QUERIES_MAX};
use super::{CategoryIndex, UnknownRule};
use crate::nearest_categories::NearestCategories;
use crate::{Error, Metric, Recognition};

/// Number of blocks up to which an index is searched exhaustively, because the cache
/// would not pay off. Chosen; sensitivity: see `tabula-lab sweep`.
const N_BLOCKS_EXHAUSTIVE: usize = 4;

/// Number of blocks searched per call in addition to the cached views. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const N_BLOCKS_PER_CALL: usize = 2;

/// Capacity of the cache, views. Chosen; sensitivity: see `tabula-lab sweep`.
const N_CACHED_VIEWS: usize = 32;

/// Number of reference descriptions per object. An object about as wide as deep
/// alternates between descriptions along either side. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const N_REFERENCES: usize = 4;

/// Ratio of the change of description to the distance of the nearest view above which
/// the cache is stale. Chosen; sensitivity: see `tabula-lab sweep`.
const CHANGE_RATIO_MAX: f32 = 0.5;

/// Cache of the nearest views of one object for
/// [`CategoryIndex::recognise_incremental`]. Sharing a cache between objects gives valid
/// results but less reuse.
#[derive(Debug, Clone, Default)]
pub struct NearestViewCache {
    /// Revision of the index; 0 for none.
    revision: u64,
    /// Reference descriptions, for which all views were compared; the hypotheses of each
    /// are concatenated.
    references: [Vec<f32>; N_REFERENCES],
    next_reference: usize,
    /// Rows of recent nearest views of a category, most recent last.
    views: Vec<u32>,
    /// Next block to search in round-robin order.
    next_block: usize,
}

impl NearestViewCache {
    /// Stores a view that became the nearest of its category.
    fn remember(&mut self, row: usize) {
        let row = row as u32;
        if let Some(place) = self.views.iter().position(|&near| near == row) {
            self.views.remove(place);
        } else if self.views.len() == N_CACHED_VIEWS {
            self.views.remove(0);
        }
        self.views.push(row);
    }

    /// Empties the cache if the index has changed.
    fn invalidate_if_stale(&mut self, revision: u64) {
        if self.revision != revision {
            self.revision = revision;
            self.views.clear();
            self.references.iter_mut().for_each(Vec::clear);
            self.next_block = 0;
        }
    }

    /// Stores the reference description of an exhaustive search.
    fn add_reference(&mut self, queries: &[&[f32]]) {
        let reference = &mut self.references[self.next_reference];
        reference.clear();
        for query in queries {
            reference.extend_from_slice(query);
        }
        self.next_reference = (self.next_reference + 1) % N_REFERENCES;
    }

    #[cfg(test)]
    pub(super) fn n_references(&self) -> usize {
        self.references
            .iter()
            .filter(|reference| !reference.is_empty())
            .count()
    }

    #[cfg(test)]
    pub(super) fn n_cached(&self) -> usize {
        self.views.len()
    }

    /// Squared distance to the nearest reference description, by the worst query;
    /// infinite without a reference.
    fn squared_change(&self, queries: &[&[f32]]) -> f32 {
        let changes = self
            .references
            .iter()
            .map(|reference| squared_change(reference, queries));
        changes.fold(f32::INFINITY, f32::min)
    }
}

/// Squared distance to one reference, by the worst query; infinite if the shapes differ.
fn squared_change(mut reference: &[f32], queries: &[&[f32]]) -> f32 {
    if reference.len() != queries.iter().map(|query| query.len()).sum::<usize>() {
        return f32::INFINITY;
    }
    let changes = queries.iter().map(|query| {
        let before;
        (before, reference) = reference.split_at(query.len());
        let score = Metric::Euclidean.bounded_score(query, before, f32::INFINITY);
        score.unwrap_or(f32::INFINITY)
    });
    changes.fold(0.0, f32::max)
}

impl CategoryIndex {
    /// Incremental recognition of a tracked object, like
    /// [`recognise_any`](Self::recognise_any) at a cost independent of the index size
    /// while the object's description is stable: the cached views and a rotating part of
    /// the others are compared.
    ///
    /// The result equals that of `recognise_any` on the first call, after each change of
    /// the index, when the description differs from the references, and while it is
    /// unchanged. Otherwise a view that became nearer than the cached ones is found some
    /// calls later: one call per 128 views covers the whole index.
    ///
    /// *Complexity*: at most 160 views, apart from exhaustive searches. Indexes with up
    /// to 256 views, other metrics, and more than four queries are always searched
    /// exhaustively.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert).
    pub fn recognise_incremental(
        &self,
        queries: &[impl AsRef<[f32]>],
        rule: impl Into<UnknownRule>,
        cache: &mut NearestViewCache,
    ) -> Result<Recognition, Error> {
        let is_small = self.views.blocks().len() <= N_BLOCKS_EXHAUSTIVE;
        if is_small || self.metric != Metric::Euclidean || queries.len() > N_QUERIES_MAX {
            return self.recognise_any(queries, rule);
        }
        let n_queries = queries.len();
        let queries = &self.checked(queries)?[..n_queries];
        let mut found = NearestCategories::default();
        cache.invalidate_if_stale(self.revision);
        if !self.search_cached(queries, cache, &mut found) {
            cache.add_reference(queries);
            let all = 0..self.views.blocks().len();
            search(&self.views, all, queries, &mut found, |row| {
                cache.remember(row);
            });
        }
        Ok(self.recognition(found, rule.into()))
    }

    /// Compares the cached views and the next blocks. `false` when the description is
    /// too far from the references, so that an exhaustive search is needed.
    fn search_cached(
        &self,
        queries: &[&[f32]],
        cache: &mut NearestViewCache,
        found: &mut NearestCategories,
    ) -> bool {
        let mut near = [0; N_CACHED_VIEWS];
        let near = &mut near[..cache.views.len()];
        near.copy_from_slice(&cache.views);
        for &row in near.iter().rev() {
            let row = row as usize;
            let block = &self.views.blocks()[row / BLOCK_LEN];
            let category = block.views()[row % BLOCK_LEN].category;
            for query in queries {
                let bound = found.bound(category);
                if block.offer(row, (self.metric, query), bound, found) {
                    cache.remember(row);
                }
            }
        }
        let nearest = found.views()[0].map_or(0.0, |nearest| nearest.score);
        if cache.squared_change(queries) > CHANGE_RATIO_MAX * CHANGE_RATIO_MAX * nearest {
            return false;
        }
        let first = cache.next_block;
        let n_blocks = self.views.blocks().len();
        let end = (first + N_BLOCKS_PER_CALL).min(n_blocks);
        cache.next_block = end % n_blocks;
        search(&self.views, first..end, queries, found, |row| {
            cache.remember(row);
        });
        true
    }
}

#[cfg(test)]
mod tests;
