//! Figure of the stops: distribution functions of the time to braking and to rest.

use super::ConditionRow;
use super::trial::StopTrial;
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, in_columns};

/// Draws the empirical distribution functions of all conditions.
pub(crate) fn figure(rows: &[ConditionRow]) -> Result<String, DrawingError> {
    let braking = diagram("Stop to braking", rows, |trial| trial.braking_ns);
    let rest = diagram("Stop to rest", rows, |trial| trial.rest_ns);
    in_columns(&[braking, rest], 2)
}

fn diagram<'a>(
    title: &'a str,
    rows: &'a [ConditionRow],
    time: fn(&StopTrial) -> Option<u64>,
) -> Diagram<'a> {
    let mut max_ms = 1.0_f64;
    let mut curves = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let mut times_ms: Vec<f64> = row
            .trials
            .iter()
            .filter_map(time)
            .map(|ns| ns as f64 * 1e-6)
            .collect();
        times_ms.sort_by(f64::total_cmp);
        let n = times_ms.len().max(1) as f64;
        max_ms = times_ms.last().map_or(max_ms, |last| max_ms.max(*last));
        let points = (1..)
            .zip(times_ms)
            .map(|(rank, ms)| (ms, f64::from(rank) / n));
        curves.push(Curve::line(
            row.condition.title(),
            Color::of_series(index),
            points.collect::<Vec<_>>(),
        ));
    }
    Diagram {
        title,
        x: Axis::linear("ms", 0.0..1.05 * max_ms),
        y: Axis::linear("share of the stops", 0.0..1.0),
        curves,
        legend: Legend::Outside,
    }
}
