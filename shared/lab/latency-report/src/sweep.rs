//! Parameter sweep: latency over one swept parameter.

use crate::duration_percentiles::DurationPercentiles;
use crate::report::LatencyReport;
use message::{Stage, StageScope};
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, side_by_side};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Share of missed frames beyond which the daemon is overloaded. Chosen.
const MISSED_SHARE_MAX: f64 = 0.01;
/// Minimum share of the end-to-end median, at any point of the sweep, for a stage to be drawn.
/// Chosen.
const DRAWN_SHARE_MIN: f64 = 0.03;

/// Measurement at one value of the swept parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepRow {
    /// Value of the swept parameter in this row.
    pub value: f64,
    /// Number of scheduled captures (frames that were due).
    pub frames: u64,
    /// Captured frames without labels.
    pub dropped: u64,
    /// Scheduled captures without a frame from the source.
    pub not_captured: u64,
    /// Mean number of objects per frame.
    pub objects: f64,
    /// Latency from scheduled capture to published labels.
    pub end_to_end_ms: DurationPercentiles,
    /// CPU utilisation of the daemon without its frame source, cores.
    pub cores: f64,
    /// Median duration of each stage, milliseconds.
    pub stage_p50_ms: BTreeMap<String, f64>,
}

impl SweepRow {
    /// Sweep row of the latency report at one value.
    pub fn new(value: f64, report: &LatencyReport) -> Self {
        let medians = report.stages.iter();
        Self {
            value,
            frames: report.frames,
            dropped: report.dropped,
            not_captured: report.not_captured,
            objects: report.objects.mean,
            end_to_end_ms: report.end_to_end_ms,
            cores: report.cores_without_source(),
            stage_p50_ms: medians
                .map(|(word, stage)| (word.clone(), stage.ms.p50))
                .collect(),
        }
    }

    /// `true` if more than 1 % of the frames were missed: the daemon does not sustain the rate.
    pub fn is_overloaded(&self) -> bool {
        let n_missed = self.dropped + self.not_captured;
        n_missed as f64 > MISSED_SHARE_MAX * self.frames as f64
    }
}

/// Latency over the swept parameter: end to end on the left, the relevant stages on the right.
///
/// # Errors
/// If the plotting library fails.
pub fn sweep_figure(axis: &str, rows: &[SweepRow]) -> Result<String, DrawingError> {
    let of_frame = DurationPercentiles::NAMED.iter().enumerate();
    let of_frame = of_frame.map(|(index, (name, get))| {
        let point = |row: &SweepRow| (row.value, get(&row.end_to_end_ms));
        curve(name, index, rows.iter().map(point).collect())
    });
    let stages = Stage::ALL.iter().filter(|stage| matters(**stage, rows));
    let stages = stages.enumerate().map(|(index, stage)| {
        let median = |row: &SweepRow| Some((row.value, *row.stage_p50_ms.get(stage.word())?));
        curve(
            stage.word(),
            index,
            rows.iter().filter_map(median).collect(),
        )
    });
    side_by_side(&[
        diagram("End to end", axis, of_frame.collect()),
        diagram("Medians of stages", axis, stages.collect()),
    ])
}

fn matters(stage: Stage, rows: &[SweepRow]) -> bool {
    let is_before_label = stage.scope() != StageScope::Outside;
    let is_large = |row: &SweepRow| {
        let median = row.stage_p50_ms.get(stage.word()).copied();
        median.unwrap_or_default() > DRAWN_SHARE_MIN * row.end_to_end_ms.p50
    };
    is_before_label && rows.iter().any(is_large)
}

fn curve(name: &str, index: usize, points: Vec<(f64, f64)>) -> Curve<'_> {
    Curve::marked(name, Color::of_series(index), points)
}

fn diagram<'a>(title: &'a str, axis: &'a str, curves: Vec<Curve<'a>>) -> Diagram<'a> {
    let values = || curves.iter().flat_map(|curve| &curve.points);
    let largest = |of: fn(&(f64, f64)) -> f64| values().map(of).fold(0.0, f64::max);
    let (last, longest) = (largest(|p| p.0), largest(|p| p.1));
    let first = values().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let x = if first > 0.0 && last > 10.0 * first {
        Axis::logarithmic(axis, first * 0.9..last * 1.1)
    } else {
        Axis::linear(axis, 0.0..last.max(1.0) * 1.05)
    };
    Diagram {
        title,
        x,
        y: Axis::linear("ms", 0.0..longest.max(0.001) * 1.1),
        curves,
        legend: Legend::Outside,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(value: f64, dropped: u64) -> SweepRow {
        let report = LatencyReport {
            frames: 300,
            dropped,
            end_to_end_ms: DurationPercentiles {
                p50: value,
                ..DurationPercentiles::default()
            },
            ..LatencyReport::default()
        };
        SweepRow::new(value, &report)
    }

    #[test]
    fn overload_begins_above_one_percent_of_missed_frames() {
        assert!(!row(30.0, 3).is_overloaded());
        assert!(row(120.0, 4).is_overloaded());
    }

    #[test]
    fn any_axis_can_be_drawn() {
        for values in [vec![1.0, 2.0], vec![10.0, 1e5], vec![7.0], Vec::new()] {
            let rows: Vec<_> = values.iter().map(|value| row(*value, 0)).collect();
            assert!(sweep_figure("objects", &rows).unwrap().contains("objects"));
        }
    }
}
