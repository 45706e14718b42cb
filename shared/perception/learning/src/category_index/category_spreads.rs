//! Maintenance of the intra-category distances of a calibrated index.

use super::CategoryIndex;
use super::intra_category_distances::{Member, ViewComparison};
use super::view_rows::ViewRows;
use super::view_table::ViewTable;
use crate::calibration::DescriptorSymmetries;
use crate::{CategoryName, Metric, ViewId};
use random::mix64;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Views that left a category and those that joined it, in this order.
#[derive(Debug, Default)]
pub(super) struct MembershipChange {
    removed: BTreeSet<ViewId>,
    added: BTreeSet<ViewId>,
}

/// Comparison of the stored views of an index.
struct StoredViews<'a> {
    views: &'a ViewTable,
    rows: &'a ViewRows,
    metric: Metric,
    symmetries: DescriptorSymmetries,
}

impl MembershipChange {
    pub(super) fn add(&mut self, view: ViewId) {
        self.added.insert(view);
    }

    pub(super) fn remove(&mut self, view: ViewId) {
        self.added.remove(&view);
        self.removed.insert(view);
    }
}

impl CategoryIndex {
    /// Brings the intra-category distances of a category up to date with its views.
    pub(super) fn update_spread(&mut self, category: &CategoryName, change: &MembershipChange) {
        let (Some(calibration), Some(category)) =
            (self.calibration, self.categories.get_mut(category))
        else {
            return;
        };
        let stored = StoredViews {
            views: &self.views,
            rows: &self.rows,
            metric: self.metric,
            symmetries: calibration.symmetries,
        };
        let member = |&id: &ViewId| {
            let hash = hash_of(stored.descriptor(id));
            Member { hash, id }
        };
        let added: Vec<Member> = change.added.iter().map(member).collect();
        let before = category.spread.distances();
        Arc::make_mut(&mut category.spread).update(&change.removed, &added, &stored);
        self.distances.exchange(before, category.spread.distances());
    }
}

impl StoredViews<'_> {
    /// Descriptor of a view; empty for an unknown one.
    fn descriptor(&self, view: ViewId) -> &[f32] {
        let row = self.rows.get(view);
        row.map_or(&[], |row| self.views.descriptor(row))
    }
}

impl ViewComparison for StoredViews<'_> {
    fn queries(&self, view: ViewId) -> Vec<Vec<f32>> {
        self.symmetries.axis_hypotheses_of(self.descriptor(view))
    }

    fn bounded_score(&self, queries: &[Vec<f32>], view: ViewId, bound: f32) -> Option<f32> {
        let stored = self.descriptor(view);
        let mut least = None;
        for query in queries {
            let bound = least.unwrap_or(bound);
            least = self.metric.bounded_score(query, stored, bound).or(least);
        }
        least
    }

    fn distance(&self, score: f32) -> f32 {
        self.metric
            .distance_from_score(score, self.views.dimension())
    }
}

/// Hash of a descriptor, the same on every machine.
fn hash_of(descriptor: &[f32]) -> u64 {
    descriptor
        .iter()
        .fold(0, |hash, value| mix64(hash ^ u64::from(value.to_bits())))
}
