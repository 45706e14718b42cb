//! What an index with a calibration keeps and says besides.

use super::CategoryIndex;
use super::spread::{Nearest, nearer};
use super::view_rows::ViewRows;
use super::view_table::ViewTable;
use crate::calibration::Distances;
use crate::recognition::N_NEAREST;
use crate::{Metric, Neighbour, ViewId};
use std::sync::Arc;

impl CategoryIndex {
    /// How new an object is with these nearest categories.
    pub(super) fn novelty(&self, nearest: &[Option<Neighbour>; N_NEAREST]) -> Option<f32> {
        let calibration = self.calibration?;
        let Some(first) = &nearest[0] else {
            return Some(f32::INFINITY);
        };
        let own = self.categories.get(&first.category);
        let own = own.map_or_else(Distances::default, |category| category.spread.distances());
        let runner_up = nearest[1].as_ref().map(|second| second.distance);
        Some(calibration.novelty(first.distance, runner_up, own, self.distances))
    }

    /// Tells a view's category that it has the view.
    pub(super) fn enter_spread(&mut self, row: usize) {
        let Some(calibration) = self.calibration else {
            return;
        };
        let (views, rows, metric) = (&self.views, &self.rows, self.metric);
        let view = views.view(row);
        let Some(category) = self.categories.get_mut(&view.name) else {
            return;
        };
        let before = category.spread.distances();
        let readings = (calibration.readings_of)(views.descriptor(row));
        let distance = |other| least_distance(views, rows, metric, &readings, other);
        Arc::make_mut(&mut category.spread).add(view.id, distance);
        self.distances.exchange(before, category.spread.distances());
    }

    /// Tells a view's category that it has the view no more.
    pub(super) fn leave_spread(&mut self, row: usize) {
        let Some(calibration) = self.calibration else {
            return;
        };
        let (views, rows, metric) = (&self.views, &self.rows, self.metric);
        let view = views.view(row);
        let Some(category) = self.categories.get_mut(&view.name) else {
            return;
        };
        let before = category.spread.distances();
        let nearest_of = |of: ViewId, others: &[ViewId]| -> Option<Nearest> {
            let readings = (calibration.readings_of)(views.descriptor(rows.get(of)?));
            let distance =
                |&other: &ViewId| (other, least_distance(views, rows, metric, &readings, other));
            others.iter().map(distance).fold(None, nearer)
        };
        Arc::make_mut(&mut category.spread).remove(view.id, nearest_of);
        self.distances.exchange(before, category.spread.distances());
    }
}

/// Distance of a view, in all its readings, to a stored one.
fn least_distance(
    views: &ViewTable,
    rows: &ViewRows,
    metric: Metric,
    readings: &[Vec<f32>],
    other: ViewId,
) -> f32 {
    let Some(row) = rows.get(other) else {
        return f32::INFINITY;
    };
    let stored = views.descriptor(row);
    let score = readings.iter().fold(f32::INFINITY, |least, reading| {
        metric
            .bounded_score(reading, stored, least)
            .unwrap_or(least)
    });
    metric.distance_from_score(score, stored.len())
}
