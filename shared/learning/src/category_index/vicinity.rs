//! Recognising an object that is seen again and again.

use super::pruned_search::search;
use super::sketch::N_TOGETHER;
use super::view_table::BLOCK;
use super::{CategoryIndex, UnknownRule};
use crate::nearest_categories::{Candidate, NearestCategories};
use crate::{Error, Metric, Recognition};

/// An index with up to so many blocks is searched whole: that costs no more than what
/// is saved.
const N_BLOCKS_WHOLE: usize = 8;

/// Blocks of a larger one that are searched each time, besides what was near before.
const N_BLOCKS_AT_ONCE: usize = 4;

/// Most views that are kept in mind.
const N_NEAR: usize = 64;

/// An object whose description has changed by more than this share of its distance to
/// the nearest view has moved, and what was near tells little.
const CHANGE_MAX: f32 = 0.5;

/// What an object was near to when it was compared last: see
/// [`CategoryIndex::recognise_again`]. One for each object; who takes that of another
/// object gets the same answers, later.
#[derive(Debug, Clone, Default)]
pub struct Vicinity {
    /// State of the index; 0 is none.
    revision: u64,
    /// The readings with which all views were compared, one after the other.
    compared: Vec<f32>,
    /// Rows of views that were the nearest of their category at some time; those
    /// that were so last are at the end.
    near: Vec<u32>,
    /// Where the search goes on.
    next_block: usize,
}

impl Vicinity {
    /// Notes that a view was the nearest of its category so far.
    fn remember(&mut self, row: usize) {
        let row = row as u32;
        if let Some(place) = self.near.iter().position(|&near| near == row) {
            self.near.remove(place);
        } else if self.near.len() == N_NEAR {
            self.near.remove(0);
        }
        self.near.push(row);
    }

    /// Begins anew with an index in this state.
    fn begin(&mut self, revision: u64, readings: &[&[f32]]) {
        self.revision = revision;
        self.near.clear();
        self.compared.clear();
        for reading in readings {
            self.compared.extend_from_slice(reading);
        }
        self.next_block = 0;
    }

    /// Whether it knows nothing of so many readings in an index of this state.
    fn is_strange(&self, revision: u64, readings: &[&[f32]]) -> bool {
        self.revision != revision
            || self.compared.len() != readings.iter().map(|reading| reading.len()).sum::<usize>()
    }

    #[cfg(test)]
    pub(super) fn n_kept(&self) -> usize {
        self.near.len()
    }

    /// Squared distance of the reading that has changed most.
    fn squared_change(&self, readings: &[&[f32]]) -> f32 {
        let mut before = self.compared.as_slice();
        let changes = readings.iter().map(|reading| {
            let own;
            (own, before) = before.split_at(reading.len());
            let score = Metric::Euclidean.bounded_score(reading, own, f32::INFINITY);
            score.unwrap_or(f32::INFINITY)
        });
        changes.fold(0.0, f32::max)
    }
}

impl CategoryIndex {
    /// Finds the category of an object like [`recognise_any`](Self::recognise_any), at
    /// a cost that does not grow with the index as long as the object stays as it is:
    /// compared are the views it was near to before, and in turn a part of the others.
    ///
    /// The answer is that of `recognise_any` when the object is new to the vicinity,
    /// after each change of the index, when its description has changed much, and as
    /// long as it has not changed at all. Otherwise a view that has come nearer than
    /// those in the vicinity is found some calls later: all views had their turn after
    /// one call for every 256 of them.
    ///
    /// *Complexity*: at most 320 views, besides those full searches. Indexes with up to
    /// 512 views, other metrics, and more than four readings are always searched whole.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert).
    pub fn recognise_again(
        &self,
        readings: &[impl AsRef<[f32]>],
        rule: impl Into<UnknownRule>,
        vicinity: &mut Vicinity,
    ) -> Result<Recognition, Error> {
        let is_small = self.views.blocks().len() <= N_BLOCKS_WHOLE;
        if is_small || self.metric != Metric::Euclidean || readings.len() > N_TOGETHER {
            return self.recognise_any(readings, rule);
        }
        let n_readings = readings.len();
        let readings = &self.checked(readings)?[..n_readings];
        let mut found = NearestCategories::default();
        if vicinity.is_strange(self.revision, readings)
            || !self.look_around(readings, vicinity, &mut found)
        {
            vicinity.begin(self.revision, readings);
            let all = 0..self.views.blocks().len();
            search(&self.views, all, readings, &mut found, |row| {
                vicinity.remember(row);
            });
        }
        Ok(self.answer(found, rule.into()))
    }

    /// Compares with what was near and with the next blocks. False when the object has
    /// changed so much that all must be compared.
    fn look_around(
        &self,
        readings: &[&[f32]],
        vicinity: &mut Vicinity,
        found: &mut NearestCategories,
    ) -> bool {
        let mut near = [0; N_NEAR];
        let near = &mut near[..vicinity.near.len()];
        near.copy_from_slice(&vicinity.near);
        for &row in near.iter().rev() {
            if self.offer(row as usize, readings, found) {
                vicinity.remember(row as usize);
            }
        }
        let nearest = found.candidates()[0].map_or(0.0, |nearest| nearest.score);
        if vicinity.squared_change(readings) > CHANGE_MAX * CHANGE_MAX * nearest {
            return false;
        }
        let first = vicinity.next_block;
        let end = (first + N_BLOCKS_AT_ONCE).min(self.views.blocks().len());
        vicinity.next_block = if end == self.views.blocks().len() {
            0
        } else {
            end
        };
        search(&self.views, first..end, readings, found, |row| {
            vicinity.remember(row);
        });
        true
    }

    /// Offers a view in all readings; says whether it became the nearest of its
    /// category.
    fn offer(&self, row: usize, readings: &[&[f32]], found: &mut NearestCategories) -> bool {
        let (block, place) = (&self.views.blocks()[row / BLOCK], row % BLOCK);
        let (view, stored) = (&block.views()[place], block.descriptor(place));
        let mut is_taken = false;
        for reading in readings {
            let bound = found.bound(view.category);
            if let Some(score) = self.metric.bounded_score(reading, stored, bound) {
                is_taken |= found.offer(Candidate {
                    score,
                    view: view.id,
                    category: view.category,
                    row,
                });
            }
        }
        is_taken
    }
}
