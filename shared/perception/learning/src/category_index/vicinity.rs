//! Recognising an object that is seen again and again.

use super::pruned_search::search;
use super::sketch::N_TOGETHER;
use super::view_table::BLOCK;
use super::{CategoryIndex, UnknownRule};
use crate::nearest_categories::NearestCategories;
use crate::{Error, Metric, Recognition};

/// An index with up to so many blocks is searched whole: that costs no more than what
/// is saved.
const N_BLOCKS_WHOLE: usize = 4;

/// Blocks of a larger one that are searched each time, besides what was near before.
const N_BLOCKS_AT_ONCE: usize = 2;

/// Most views that are kept in mind.
const N_NEAR: usize = 32;

/// Descriptions around which an object is known: what is about as wide as deep is
/// described now along one side and now along the other.
const N_PLACES: usize = 4;

/// A description that is farther from all known ones than this share of its distance to
/// the nearest view is another one, and what was near tells little.
const CHANGE_MAX: f32 = 0.5;

/// What an object was near to when it was compared last: see
/// [`CategoryIndex::recognise_again`]. One for each object; who takes that of another
/// object gets the same answers, later.
#[derive(Debug, Clone, Default)]
pub struct Vicinity {
    /// State of the index; 0 is none.
    revision: u64,
    /// Descriptions with which all views were compared, each with its readings one
    /// after the other.
    places: [Vec<f32>; N_PLACES],
    next_place: usize,
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

    /// Forgets what is known of another state of the index.
    fn begin(&mut self, revision: u64) {
        if self.revision != revision {
            self.revision = revision;
            self.near.clear();
            self.places.iter_mut().for_each(Vec::clear);
            self.next_block = 0;
        }
    }

    /// Notes that all views were compared with these readings.
    fn settle(&mut self, readings: &[&[f32]]) {
        let place = &mut self.places[self.next_place];
        place.clear();
        for reading in readings {
            place.extend_from_slice(reading);
        }
        self.next_place = (self.next_place + 1) % N_PLACES;
    }

    #[cfg(test)]
    pub(super) fn n_settled(&self) -> usize {
        self.places.iter().filter(|place| !place.is_empty()).count()
    }

    #[cfg(test)]
    pub(super) fn n_kept(&self) -> usize {
        self.near.len()
    }

    /// Squared distance to the nearest known description, by the reading that differs
    /// most; infinite when none is known.
    fn squared_change(&self, readings: &[&[f32]]) -> f32 {
        let changes = self
            .places
            .iter()
            .map(|place| squared_change(place, readings));
        changes.fold(f32::INFINITY, f32::min)
    }
}

/// From the readings of a place; infinite where it has others.
fn squared_change(mut place: &[f32], readings: &[&[f32]]) -> f32 {
    if place.len() != readings.iter().map(|reading| reading.len()).sum::<usize>() {
        return f32::INFINITY;
    }
    let changes = readings.iter().map(|reading| {
        let before;
        (before, place) = place.split_at(reading.len());
        let score = Metric::Euclidean.bounded_score(reading, before, f32::INFINITY);
        score.unwrap_or(f32::INFINITY)
    });
    changes.fold(0.0, f32::max)
}

impl CategoryIndex {
    /// Finds the category of an object like [`recognise_any`](Self::recognise_any), at
    /// a cost that does not grow with the index as long as the object stays as it is:
    /// compared are the views it was near to before, and in turn a part of the others.
    ///
    /// The answer is that of `recognise_any` when the object is new to the vicinity,
    /// after each change of the index, when its description is unlike those before, and
    /// as long as it does not change. Otherwise a view that has come nearer than
    /// those in the vicinity is found some calls later: all views had their turn after
    /// one call for every 128 of them.
    ///
    /// *Complexity*: at most 160 views, besides those full searches. Indexes with up to
    /// 256 views, other metrics, and more than four readings are always searched whole.
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
        vicinity.begin(self.revision);
        if !self.look_around(readings, vicinity, &mut found) {
            vicinity.settle(readings);
            let all = 0..self.views.blocks().len();
            search(&self.views, all, readings, &mut found, |row| {
                vicinity.remember(row);
            });
        }
        Ok(self.answer(found, rule.into()))
    }

    /// Compares with what was near and with the next blocks. False when the description
    /// is one of which little is known, so that all must be compared.
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
            let row = row as usize;
            let block = &self.views.blocks()[row / BLOCK];
            let category = block.views()[row % BLOCK].category;
            for reading in readings {
                let bound = found.bound(category);
                if block.offer(row, (self.metric, reading), bound, found) {
                    vicinity.remember(row);
                }
            }
        }
        let nearest = found.candidates()[0].map_or(0.0, |nearest| nearest.score);
        if vicinity.squared_change(readings) > CHANGE_MAX * CHANGE_MAX * nearest {
            return false;
        }
        let first = vicinity.next_block;
        let n_blocks = self.views.blocks().len();
        let end = (first + N_BLOCKS_AT_ONCE).min(n_blocks);
        vicinity.next_block = end % n_blocks;
        search(&self.views, first..end, readings, found, |row| {
            vicinity.remember(row);
        });
        true
    }
}
