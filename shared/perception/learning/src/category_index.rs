//! Nearest-neighbour index of taught views by category.

mod batch;
mod category_spreads;
mod change_log;
mod evidence;
mod intra_category_distances;
mod local_ridge;
mod pruned_search;
mod sketch;
mod track_evidence;
mod view_rows;
mod view_table;

use crate::calibration::{Calibration, DescriptorMap, DistanceSum};
use crate::nearest_categories::{CategoryMinima, NearestCategories, NearestList, ScoredView};
use crate::nearest_neighbours::NearestNeighbours;
use crate::{CategoryName, Error, Metric, Neighbour, Recognition, UnknownRule, ViewId};
use change_log::ChangeLog;
use evidence::{Evidence, N_NEIGHBOURS};
use intra_category_distances::IntraCategoryDistances;
use sketch::{BLOCK_LEN, N_QUERIES_MAX};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use view_rows::ViewRows;
use view_table::ViewTable;

pub use batch::IndexBatch;
pub use track_evidence::{TrackEvidence, ViewUse};

/// Nearest-neighbour index over the descriptors of taught views.
///
/// Changes are idempotent: replaying them in the same order over a newer state gives the
/// same index, since the last change of each view decides.
///
/// Clones share the views copy-on-write, in blocks of 64 views, so that one thread may
/// read a clone while another one extends the index. A clone and the first change after
/// it take microseconds.
///
/// *Shape*: the descriptors of a block are contiguous, one row per view.
///
/// *Memory*: a view takes 4 bytes per value and about 80 for its names; with
/// [`Metric::Euclidean`] another 268 bytes for the sketch of the pruned search.
#[derive(Debug, Clone)]
pub struct CategoryIndex {
    metric: Metric,
    dimension: usize,
    /// Revision number, unique for each state of each clone.
    revision: u64,
    /// Newest changes of views.
    changes: ChangeLog,
    views: ViewTable,
    rows: ViewRows,
    categories: BTreeMap<CategoryName, Category>,
    next_category: u64,
    calibration: Option<Calibration>,
    /// Nearest-neighbour distances of all categories together.
    distances: DistanceSum,
}

/// Category with at least one view.
#[derive(Debug, Clone)]
struct Category {
    /// Category number, never reused.
    number: u64,
    n_views: usize,
    /// Distances between the views; empty without a calibration.
    spread: Arc<IntraCategoryDistances>,
}

impl CategoryIndex {
    /// Empty index for descriptors of `dimension` values. With [`Metric::Euclidean`] the
    /// first 64 values should be those of the largest variance, because the search
    /// prunes views by them.
    pub fn new(dimension: usize, metric: Metric) -> Self {
        let revision = new_revision();
        Self {
            metric,
            dimension,
            revision,
            changes: ChangeLog::new(revision),
            views: ViewTable::new(dimension, metric == Metric::Euclidean),
            rows: ViewRows::new(),
            categories: BTreeMap::new(),
            next_category: 0,
            calibration: None,
            distances: DistanceSum::default(),
        }
    }

    /// Empty index with a probability calibration; any views are removed.
    ///
    /// *Complexity*: a changed view is compared with at most 256 others on average.
    #[must_use]
    pub fn with_calibration(mut self, calibration: Calibration) -> Self {
        self.clear();
        self.calibration = Some(calibration);
        let dimension = self
            .learned_metric()
            .map_or(self.dimension, |one| one.dimension);
        self.views = ViewTable::new(dimension, self.metric == Metric::Euclidean);
        self
    }

    /// Begins a batch of changes, which costs less than one change after another.
    pub fn batch(&mut self) -> IndexBatch<'_> {
        IndexBatch::new(self)
    }

    /// Inserts a view: a [batch](IndexBatch::insert) of one.
    ///
    /// # Errors
    /// As for [`IndexBatch::insert`].
    pub fn insert(
        &mut self,
        id: ViewId,
        category: &CategoryName,
        descriptor: &[f32],
    ) -> Result<(), Error> {
        self.batch().insert(id, category, descriptor)
    }

    /// Removes a view; `false` if the view is unknown.
    pub fn remove_view(&mut self, id: ViewId) -> bool {
        self.batch().remove_view(id)
    }

    /// Removes all views from the index.
    pub fn clear(&mut self) {
        self.revision = new_revision();
        self.changes = ChangeLog::new(self.revision);
        self.views.clear();
        self.rows = ViewRows::new();
        self.categories.clear();
        self.distances = DistanceSum::default();
    }

    /// Metric of the descriptor distances.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// Length of the descriptors in the index, values.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of views in the index.
    pub fn n_views(&self) -> usize {
        self.views.len()
    }

    /// Categories with their numbers of views, ordered by name.
    pub fn categories(&self) -> impl ExactSizeIterator<Item = (&CategoryName, usize)> {
        self.categories
            .iter()
            .map(|(name, category)| (name, category.n_views))
    }

    /// True if a category has a view.
    pub fn contains(&self, category: &CategoryName) -> bool {
        self.categories.contains_key(category)
    }

    /// Categories of the tracks whose views were stored or relabelled since an earlier state of this
    /// index, by track-id. Empty when the change log does not reach back.
    pub fn taught_since(&self, earlier: &Self) -> BTreeMap<u64, CategoryName> {
        let changes = self.changes.since(earlier.revision).into_iter().flatten();
        let taught = changes.filter_map(|view| {
            let row = self.rows.get(view)?;
            Some((view.track_id, self.views.view(row).name.clone()))
        });
        taught.collect()
    }

    /// Recognition of a descriptor. With a calibration the category of the greatest score
    /// wins in a local ridge regression over the nearest views, else that of the nearest
    /// view, unless `rule` rejects it as unknown. Ties are broken by the smaller view id,
    /// so the order of teaching is irrelevant.
    ///
    /// A category with a single view can win. A taught view is found at the metric's
    /// least distance, which is 0 for all metrics but Motyka's.
    ///
    /// *Complexity*: linear in the views. With [`Metric::Euclidean`] views are pruned by a
    /// lower bound of their distance; with other metrics a comparison ends early where the
    /// metric allows it. The pruned result equals the exhaustive one bit for bit.
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

    /// Recognition of an object with several descriptors, such as those of all axis
    /// hypotheses: the distance of a view is the least over them. Without descriptors the object is unknown.
    ///
    /// *Complexity*: as for [`recognise`](Self::recognise) with each descriptor, or
    /// less, since the result of one descriptor prunes the search of the next. With
    /// [`Metric::Euclidean`] four descriptors are compared at once; values that they
    /// share cost as much as one descriptor.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert).
    pub fn recognise_any(
        &self,
        descriptors: &[impl AsRef<[f32]>],
        rule: impl Into<UnknownRule>,
    ) -> Result<Recognition, Error> {
        let rule = rule.into();
        if self.is_regression() {
            let evidence = self.evidence_of(descriptors)?;
            return Ok(self.decide(std::iter::once(&evidence), rule));
        }
        let mut found = NearestCategories::default();
        self.search_all(&self.compared(descriptors)?, &mut found);
        Ok(self.nearest_view_answer(found, rule))
    }

    /// Recognition of an object with several descriptions, such as views of its different
    /// sides, each with its descriptors under all axis hypotheses: their mean evidence
    /// decides. Without a calibration it is the least sum of the distances of a category.
    ///
    /// # Errors
    /// As for [`insert`](Self::insert).
    pub fn recognise_sides<D: AsRef<[f32]>>(
        &self,
        sides: &[impl AsRef<[D]>],
        rule: impl Into<UnknownRule>,
    ) -> Result<Recognition, Error> {
        if !self.is_regression() {
            return self.least_sum_of_distances(sides, rule.into());
        }
        let evidence = sides.iter().map(|side| self.evidence_of(side.as_ref()));
        let evidence = evidence.collect::<Result<Vec<_>, Error>>()?;
        Ok(self.decide(evidence.iter(), rule.into()))
    }

    /// Evidence of a description in all axis hypotheses: an exhaustive search.
    fn evidence_of(&self, descriptors: &[impl AsRef<[f32]>]) -> Result<Evidence, Error> {
        let queries = self.compared(descriptors)?;
        let mut found = NearestNeighbours::new(N_NEIGHBOURS);
        self.search_all(&queries, &mut found);
        let description = queries.first().map(Vec::as_slice);
        Ok(self.evidence(description, found.views()))
    }

    /// True if recognition is by local ridge regression, else by the nearest view.
    fn is_regression(&self) -> bool {
        self.calibration.is_some() && self.metric == Metric::Euclidean
    }

    fn learned_metric(&self) -> Option<DescriptorMap> {
        let calibration = self.calibration.filter(|_| self.is_regression());
        calibration.and_then(|calibration| calibration.learned_metric)
    }

    fn least_sum_of_distances<D: AsRef<[f32]>>(
        &self,
        sides: &[impl AsRef<[D]>],
        rule: UnknownRule,
    ) -> Result<Recognition, Error> {
        let mut sums: BTreeMap<u64, (f32, ScoredView)> = BTreeMap::new();
        for side in sides {
            let mut found = CategoryMinima::default();
            self.search_all(&self.compared(side.as_ref())?, &mut found);
            for (category, nearest) in found.views {
                let distance = self
                    .metric
                    .distance_from_score(nearest.score, self.dimension);
                let (sum, least) = sums.entry(category).or_insert((0.0, nearest));
                *sum += distance;
                if nearest.precedes(least) {
                    *least = nearest;
                }
            }
        }
        let mut found = NearestCategories::default();
        let per_side = (sides.len().max(1) as f32).recip();
        let mut distances = BTreeMap::new();
        for (category, (sum, nearest)) in sums {
            found.offer(ScoredView {
                score: sum,
                ..nearest
            });
            distances.insert(category, sum * per_side);
        }
        let mut answer = self.nearest_view_answer(found, UnknownRule::FartherThan(f32::INFINITY));
        let categories = found
            .views()
            .map(|scored| scored.map(|scored| scored.category));
        for (neighbour, category) in answer.nearest.iter_mut().zip(categories) {
            if let (Some(neighbour), Some(category)) = (neighbour, category) {
                neighbour.distance = distances[&category];
            }
        }
        Ok(Self::judged(answer, sides.len(), rule))
    }

    fn search_all(&self, queries: &[Vec<f32>], found: &mut impl NearestList) {
        let queries: Vec<&[f32]> = queries.iter().map(Vec::as_slice).collect();
        for queries in queries.chunks(N_QUERIES_MAX) {
            match self.metric {
                Metric::Euclidean => {
                    let all = 0..self.views.blocks().len();
                    pruned_search::search(&self.views, all, queries, found);
                }
                _ => self.compare_all(queries, found),
            }
        }
    }

    fn compare_all(&self, queries: &[&[f32]], found: &mut impl NearestList) {
        for query in queries {
            for (block, first_row) in self.views.blocks().iter().zip((0..).step_by(BLOCK_LEN)) {
                for (row, view) in (first_row..).zip(block.views()) {
                    let bound = found.bound(view.category);
                    block.offer(row, (self.metric, query), bound, found);
                }
            }
        }
    }

    /// Answer of an index without calibration: the category of the nearest view.
    fn nearest_view_answer(&self, found: NearestCategories, rule: UnknownRule) -> Recognition {
        let nearest = found.views().map(|scored| {
            scored.map(
                |ScoredView {
                     score, view, row, ..
                 }| Neighbour {
                    view,
                    category: self.views.view(row).name.clone(),
                    distance: self.metric.distance_from_score(score, self.dimension),
                    probability: None,
                },
            )
        });
        let answer = Recognition {
            label: None,
            distance: f32::INFINITY,
            novelty: None,
            probability: None,
            known_probability: None,
            n_sides: 1,
            nearest,
        };
        Self::judged(answer, 1, rule)
    }

    /// Answer with distance and label of its nearest category, unless the rule rejects it.
    fn judged(mut answer: Recognition, n_sides: usize, rule: UnknownRule) -> Recognition {
        let first = answer.nearest[0].as_ref();
        answer.distance = first.map_or(f32::INFINITY, |first| first.distance);
        let is_known = match rule {
            UnknownRule::FartherThan(threshold) => answer.distance <= threshold,
            UnknownRule::LessProbableThan { .. } => true,
        };
        let winner = first.filter(|_| is_known);
        answer.label = winner.map(|first| first.category.clone());
        answer.n_sides = n_sides;
        answer
    }

    /// Checked descriptors in the space in which they are compared.
    fn compared(&self, descriptors: &[impl AsRef<[f32]>]) -> Result<Vec<Vec<f32>>, Error> {
        let mut compared = vec![Vec::new(); descriptors.len()];
        self.compare_into(descriptors, &mut compared)?;
        Ok(compared)
    }

    /// Writes checked descriptors as they are compared, as many as there is room for.
    fn compare_into(
        &self,
        descriptors: &[impl AsRef<[f32]>],
        compared: &mut [Vec<f32>],
    ) -> Result<(), Error> {
        let learned = self.learned_metric();
        for (descriptor, compared) in descriptors.iter().zip(compared) {
            let descriptor = descriptor.as_ref();
            self.check(descriptor)?;
            if let Some(learned) = learned {
                (learned.map)(descriptor, compared);
            } else {
                compared.clear();
                compared.extend_from_slice(descriptor);
            }
        }
        Ok(())
    }

    fn check(&self, descriptor: &[f32]) -> Result<(), Error> {
        self.metric.check(descriptor, self.dimension)
    }
}

/// Revision that no other state of any index has; later ones are larger.
fn new_revision() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

#[cfg(test)]
mod test_views;
#[cfg(test)]
mod tests;
