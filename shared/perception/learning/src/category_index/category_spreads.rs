//! Maintenance of the intra-category distances of a calibrated index.

use super::CategoryIndex;
use super::intra_category_distances::{NeighbourDistance, nearer};
use super::view_rows::ViewRows;
use super::view_table::ViewTable;
use crate::{Metric, ViewId};
use std::sync::Arc;

impl CategoryIndex {
    /// Adds a view to the intra-category distances of its category.
    pub(super) fn add_to_spread(&mut self, row: usize) {
        let Some(calibration) = self.calibration else {
            return;
        };
        let (views, rows, metric) = (&self.views, &self.rows, self.metric);
        let view = views.view(row);
        let Some(category) = self.categories.get_mut(&view.name) else {
            return;
        };
        let before = category.spread.distances();
        let queries = (calibration.axis_hypotheses_of)(views.descriptor(row));
        let distance = |other| least_distance(views, rows, metric, &queries, other);
        Arc::make_mut(&mut category.spread).add(view.id, distance);
        self.distances.exchange(before, category.spread.distances());
    }

    /// Removes a view from the intra-category distances of its category.
    pub(super) fn remove_from_spread(&mut self, row: usize) {
        let Some(calibration) = self.calibration else {
            return;
        };
        let (views, rows, metric) = (&self.views, &self.rows, self.metric);
        let view = views.view(row);
        let Some(category) = self.categories.get_mut(&view.name) else {
            return;
        };
        let before = category.spread.distances();
        let nearest_of = |of: ViewId, others: &[ViewId]| -> Option<NeighbourDistance> {
            let queries = (calibration.axis_hypotheses_of)(views.descriptor(rows.get(of)?));
            let distance =
                |&other: &ViewId| (other, least_distance(views, rows, metric, &queries, other));
            others.iter().map(distance).fold(None, nearer)
        };
        Arc::make_mut(&mut category.spread).remove(view.id, nearest_of);
        self.distances.exchange(before, category.spread.distances());
    }
}

/// Distance of a view, over all its axis hypotheses, to a stored view.
fn least_distance(
    views: &ViewTable,
    rows: &ViewRows,
    metric: Metric,
    queries: &[Vec<f32>],
    other: ViewId,
) -> f32 {
    let Some(row) = rows.get(other) else {
        return f32::INFINITY;
    };
    let stored = views.descriptor(row);
    let score = queries.iter().fold(f32::INFINITY, |least, query| {
        metric.bounded_score(query, stored, least).unwrap_or(least)
    });
    metric.distance_from_score(score, stored.len())
}
