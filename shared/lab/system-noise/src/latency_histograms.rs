//! Latency histograms as SVG.

use crate::measurement::MachineReport;
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, in_columns};
use std::collections::BTreeMap;

/// Height at which an empty bin is drawn, so that a count of 1 is visible.
const EMPTY: f64 = 0.5;

/// Histograms of all latencies as SVG, log count over log µs (after cyclictest's plots): timers
/// under each setting, idle and busy, and the gaps of a spinning thread.
///
/// # Errors
/// If the plotting library fails.
pub fn histograms(report: &MachineReport) -> Result<String, DrawingError> {
    let timers = |is_loaded| {
        let trials = report.timers.iter();
        let trials = trials.filter(move |trial| trial.is_loaded == is_loaded);
        trials
            .map(|trial| (trial.setting.word(), &trial.counts))
            .collect::<Vec<_>>()
    };
    let gaps = report.interruptions.iter();
    let gaps: Vec<_> = gaps.map(|found| ("interruptions", &found.counts)).collect();
    let diagrams = [
        diagram("Timer, idle machine", &timers(false)),
        diagram("Timer, a busy thread on every core", &timers(true)),
        diagram("Interruptions of a spinning thread", &gaps),
    ];
    in_columns(&diagrams, 3)
}

fn diagram<'a>(title: &'a str, series: &[(&'a str, &BTreeMap<u64, u64>)]) -> Diagram<'a> {
    let counts = || series.iter().flat_map(|(_, counts)| counts.iter());
    let longest = counts().map(|(us, _)| *us).max().unwrap_or(1);
    let highest = counts().map(|(_, n)| *n).max().unwrap_or(1);
    let curves = series
        .iter()
        .zip(0..)
        .map(|((name, counts), index)| Curve::line(name, Color::of_series(index), steps(counts)));
    Diagram {
        title,
        x: Axis::logarithmic("µs", 1.0..2.0 * longest as f64),
        y: Axis::logarithmic("samples", EMPTY..3.0 * highest as f64),
        curves: curves.collect(),
        legend: Legend::UpperRight,
    }
}

/// Outline of a histogram with bins of 1 µs; values below 1 µs are drawn at 1 µs.
fn steps(counts: &BTreeMap<u64, u64>) -> Vec<(f64, f64)> {
    let steps = counts.iter().flat_map(|(us, n)| {
        let (left, right) = ((*us).max(1) as f64, us.max(&1).saturating_add(1) as f64);
        [
            (left, EMPTY),
            (left, *n as f64),
            (right, *n as f64),
            (right, EMPTY),
        ]
    });
    steps.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn step_is_as_high_as_its_bin_has_values() {
        let outline = steps(&[(0, 2), (10, 7)].into());
        assert_eq!(outline[1..3], [(1.0, 2.0), (2.0, 2.0)]);
        assert_eq!(outline[5..7], [(10.0, 7.0), (11.0, 7.0)]);
    }
}
