//! Novelty scores and the maintenance of intra-category distances of a calibrated index.

use super::CategoryIndex;
use super::intra_category_distances::{NeighbourDistance, nearer};
use super::view_rows::ViewRows;
use super::view_table::ViewTable;
use crate::calibration::DistanceSum;
use crate::recognition::N_NEAREST;
use crate::{Metric, Neighbour, ViewId};
use std::sync::Arc;

impl CategoryIndex {
    /// Novelty score of an object from its nearest categories; `None` without a
    /// calibration.
    pub(super) fn novelty(&self, nearest: &[Option<Neighbour>; N_NEAREST]) -> Option<f32> {
        let calibration = self.calibration?;
        let Some(first) = &nearest[0] else {
            return Some(f32::INFINITY);
        };
        let own = self.categories.get(&first.category);
        let own = own.map_or_else(DistanceSum::default, |category| category.spread.distances());
        let runner_up = nearest[1].as_ref().map(|second| second.distance);
        Some(calibration.novelty(first.distance, runner_up, own, self.distances))
    }

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
