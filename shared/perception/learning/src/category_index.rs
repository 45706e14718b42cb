//! The taught views, ready to be compared with.

mod calibrated;
mod pruned_search;
mod sketch;
mod spread;
mod vicinity;
mod view_rows;
mod view_table;

use crate::calibration::{Calibration, Distances};
use crate::nearest_categories::{Candidate, NearestCategories};
use crate::{CategoryName, Error, Metric, Neighbour, Recognition, UnknownRule, ViewId};
use sketch::N_TOGETHER;
use spread::Spread;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use view_rows::ViewRows;
use view_table::{BLOCK, IndexedView, ViewTable};

pub use vicinity::Vicinity;

/// Taught views with their categories and descriptors.
///
/// Changes of single views can be applied again, in the same order, over a newer
/// state: a view that is there is replaced, one that is not there is not missed,
/// and the last change of each view decides. Only the removal of a category must
/// not be replayed over views that came to it later.
///
/// A clone shares the views with its original, in blocks of 64; a change copies
/// the block it is in when a clone holds it, too. So one may read a clone while
/// another extends the index: making the clone and the first change after it take
/// microseconds.
///
/// *Shape*: the descriptors of a block lie in one piece of memory, a row for each
/// view.
///
/// *Memory*: a view takes 4 bytes a value and about 80 for its names; with
/// [`Metric::Euclidean`] 268 bytes more, the sketch by which it is passed over.
#[derive(Debug, Clone)]
pub struct CategoryIndex {
    metric: Metric,
    dimension: usize,
    /// Tells states apart, also those of clones that went different ways.
    revision: u64,
    views: ViewTable,
    rows: ViewRows,
    categories: BTreeMap<CategoryName, Category>,
    next_category: u64,
    calibration: Option<Calibration>,
    /// Of all categories together.
    distances: Distances,
}

/// A category with at least one view.
#[derive(Debug, Clone)]
struct Category {
    /// Never used again when the category is gone.
    number: u64,
    n_views: usize,
    /// Empty without a calibration.
    spread: Arc<Spread>,
}

impl CategoryIndex {
    /// An index for descriptors of `dimension` values. With [`Metric::Euclidean`]
    /// the first 64 values should be those that differ most between views: a view is
    /// passed over by them.
    pub fn new(dimension: usize, metric: Metric) -> Self {
        Self {
            metric,
            dimension,
            revision: new_revision(),
            views: ViewTable::new(dimension, metric == Metric::Euclidean),
            rows: ViewRows::new(),
            categories: BTreeMap::new(),
            next_category: 0,
            calibration: None,
            distances: Distances::default(),
        }
    }

    /// The same, which also says how probable its answers are.
    ///
    /// *Complexity*: what is taught is compared with all views of its category, what
    /// is removed costs the same for each view whose nearest it was.
    #[must_use]
    pub fn with_calibration(mut self, calibration: Calibration) -> Self {
        self.clear();
        self.calibration = Some(calibration);
        self
    }

    /// Adds a view to a category. A view with the same id is replaced.
    ///
    /// # Errors
    /// When the descriptor has another length, or a value that the metric does not
    /// take; the index is unchanged then.
    pub fn insert(
        &mut self,
        id: ViewId,
        category: &CategoryName,
        descriptor: &[f32],
    ) -> Result<(), Error> {
        self.check(descriptor)?;
        self.revision = new_revision();
        if let Some(row) = self.rows.get(id) {
            self.leave_spread(row);
            self.views.describe(row, descriptor);
            self.assign(row, category);
            self.enter_spread(row);
        } else {
            let number = self.enter(category);
            self.rows.insert(id, self.views.len());
            let view = IndexedView {
                id,
                name: category.clone(),
                category: number,
            };
            self.views.push(view, descriptor);
            self.enter_spread(self.views.len() - 1);
        }
        Ok(())
    }

    /// Moves a view to another category; says whether the view was there.
    pub fn move_view(&mut self, id: ViewId, category: &CategoryName) -> bool {
        let row = self.rows.get(id);
        if let Some(row) = row {
            self.revision = new_revision();
            self.leave_spread(row);
            self.assign(row, category);
            self.enter_spread(row);
        }
        row.is_some()
    }

    /// Removes a view; says whether it was there.
    pub fn remove_view(&mut self, id: ViewId) -> bool {
        let Some(row) = self.rows.get(id) else {
            return false;
        };
        self.revision = new_revision();
        self.leave_spread(row);
        self.rows.remove(id);
        if let Some(removed) = self.views.swap_remove(row) {
            self.leave(&removed.name);
        }
        if row < self.views.len() {
            self.rows.insert(self.views.view(row).id, row);
        }
        true
    }

    /// Removes a category with all its views; says how many there were.
    pub fn remove_category(&mut self, category: &CategoryName) -> usize {
        let of_category = |view: &&IndexedView| view.name == *category;
        let ids: Vec<ViewId> = self
            .views
            .blocks()
            .iter()
            .flat_map(|block| block.views())
            .filter(of_category)
            .map(|view| view.id)
            .collect();
        ids.into_iter().filter(|&id| self.remove_view(id)).count()
    }

    /// Removes everything.
    pub fn clear(&mut self) {
        self.revision = new_revision();
        self.views.clear();
        self.rows = ViewRows::new();
        self.categories.clear();
        self.distances = Distances::default();
    }

    /// The metric of the distances.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// Number of values of a descriptor.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of views.
    pub fn n_views(&self) -> usize {
        self.views.len()
    }

    /// The categories with their numbers of views, in the order of their names.
    pub fn categories(&self) -> impl ExactSizeIterator<Item = (&CategoryName, usize)> {
        self.categories
            .iter()
            .map(|(name, category)| (name, category.n_views))
    }

    /// Finds the category of a descriptor: that of the nearest of all views unless
    /// `rule` says that it is unknown. Of equally near views the one
    /// with the smaller id counts, so the order of teaching has no say.
    ///
    /// A category with a single view can win, and a view that was taught is found at
    /// the metric's least distance, 0 with all but Motyka's.
    ///
    /// *Complexity*: linear in the views. With [`Metric::Euclidean`] only those are
    /// compared of which a lower bound of their distance says that they may belong
    /// to the nearest categories; with other metrics all are, and where the metric
    /// allows it, a comparison ends as soon as the view can not belong to them. The
    /// answer is the same as without these shortcuts, to the bit. No allocation.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert).
    pub fn recognise(
        &self,
        descriptor: &[f32],
        rule: impl Into<UnknownRule>,
    ) -> Result<Recognition, Error> {
        self.recognise_any(&[descriptor], rule)
    }

    /// Finds the category of an object that was described in several ways: what is
    /// nearest to any of the descriptors is nearest to the object. Without a
    /// descriptor nothing is.
    ///
    /// *Complexity*: as for [`recognise`](Self::recognise) with each descriptor, or
    /// less: what one of them was near to ends the comparisons of the next earlier.
    /// With [`Metric::Euclidean`] four descriptors are compared at once, at the price
    /// of one for all values that they share.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert).
    pub fn recognise_any(
        &self,
        descriptors: &[impl AsRef<[f32]>],
        rule: impl Into<UnknownRule>,
    ) -> Result<Recognition, Error> {
        let mut found = NearestCategories::default();
        for descriptors in descriptors.chunks(N_TOGETHER) {
            let readings = self.checked(descriptors)?;
            let readings = &readings[..descriptors.len()];
            match self.metric {
                Metric::Euclidean => {
                    let all = 0..self.views.blocks().len();
                    pruned_search::search(&self.views, all, readings, &mut found, |_| {});
                }
                _ => self.compare_all(readings, &mut found),
            }
        }
        Ok(self.answer(found, rule.into()))
    }

    fn compare_all(&self, readings: &[&[f32]], found: &mut NearestCategories) {
        for reading in readings {
            for (block, first_row) in self.views.blocks().iter().zip((0..).step_by(BLOCK)) {
                for (row, view) in (first_row..).zip(block.views()) {
                    let bound = found.bound(view.category);
                    block.offer(row, (self.metric, reading), bound, found);
                }
            }
        }
    }

    fn answer(&self, found: NearestCategories, rule: UnknownRule) -> Recognition {
        let nearest = found.candidates().map(|candidate| {
            candidate.map(
                |Candidate {
                     score, view, row, ..
                 }| Neighbour {
                    view,
                    category: self.views.view(row).name.clone(),
                    distance: self.metric.distance_from_score(score, self.dimension),
                },
            )
        });
        let distance = nearest[0]
            .as_ref()
            .map_or(f32::INFINITY, |first| first.distance);
        let novelty = self.novelty(&nearest);
        let probability = self
            .calibration
            .and_then(|calibration| novelty.map(|novelty| calibration.probability(novelty)));
        let is_known = match rule {
            UnknownRule::FartherThan(threshold) => distance <= threshold,
            UnknownRule::LessProbableThan(least) => probability.is_none_or(|p| p >= least),
        };
        let winner = nearest[0].as_ref().filter(|_| is_known);
        Recognition {
            label: winner.map(|first| first.category.clone()),
            distance,
            novelty,
            probability,
            nearest,
        }
    }

    /// Up to four descriptors, behind which the array is empty.
    fn checked<'a>(
        &self,
        descriptors: &'a [impl AsRef<[f32]>],
    ) -> Result<[&'a [f32]; N_TOGETHER], Error> {
        let mut readings: [&[f32]; N_TOGETHER] = [&[]; N_TOGETHER];
        for (reading, descriptor) in readings.iter_mut().zip(descriptors) {
            *reading = descriptor.as_ref();
            self.check(reading)?;
        }
        Ok(readings)
    }

    fn check(&self, descriptor: &[f32]) -> Result<(), Error> {
        self.metric.check(descriptor, self.dimension)
    }

    fn assign(&mut self, row: usize, category: &CategoryName) {
        if self.views.view(row).name == *category {
            return;
        }
        let number = self.enter(category);
        let view = self.views.view_mut(row);
        view.category = number;
        let left = std::mem::replace(&mut view.name, category.clone());
        self.leave(&left);
    }

    /// Counts one more view of a category and returns its number.
    fn enter(&mut self, category: &CategoryName) -> u64 {
        let next = &mut self.next_category;
        let entry = self.categories.entry(category.clone()).or_insert_with(|| {
            *next += 1;
            Category {
                number: *next,
                n_views: 0,
                spread: Arc::default(),
            }
        });
        entry.n_views += 1;
        entry.number
    }

    /// Counts one view less of a category and forgets it with the last one.
    fn leave(&mut self, category: &CategoryName) {
        if let Some(entry) = self.categories.get_mut(category) {
            entry.n_views -= 1;
            if entry.n_views == 0 {
                self.categories.remove(category);
            }
        }
    }
}

fn new_revision() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

#[cfg(test)]
mod again;
#[cfg(test)]
mod exactness;
#[cfg(test)]
mod tests;
