//! Latency histograms as SVG.

use crate::measurement::MachineReport;
use crate::samples::Samples;
use crate::thread_setting::{SettingTrial, ThreadSetting};
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, in_columns};
use std::borrow::Cow;

/// Number of histogram bins per decade.
const BINS_PER_DECADE: i32 = 20;
/// Height at which an empty bin is drawn, so that a count of 1 is visible.
const EMPTY: f64 = 0.5;

/// Categorical colours, distinguishable on white.
const COLORS: [Color; 6] = [
    Color(31, 119, 180),
    Color(214, 39, 40),
    Color(44, 160, 44),
    Color(148, 103, 189),
    Color(255, 127, 14),
    Color(140, 86, 75),
];
/// Colour of the baseline.
const BASELINE_COLOR: Color = Color(110, 110, 110);

/// Histogram of a panel: legend, colour and values.
struct Series<'a> {
    name: String,
    color: Color,
    values_ns: Cow<'a, [u64]>,
}

/// Histograms of all latencies as SVG, log count over log µs (after cyclictest's plots): the
/// probes and the gaps, and timer and wake-up under each setting, idle and busy.
///
/// # Errors
/// If the plotting library fails.
pub fn histograms(report: &MachineReport) -> Result<String, DrawingError> {
    let (hops, mut noise): (Vec<&Samples>, Vec<&Samples>) = report
        .latencies
        .iter()
        .partition(|samples| samples.name.starts_with("hop"));
    noise.push(&report.interruptions.gaps);
    let mut panels = vec![
        ("Noise of this machine", of_probes(&noise)),
        ("Hops through shared memory", of_probes(&hops)),
    ];
    let trials = |is_loaded, probe| of_trials(&report.trials, is_loaded, probe);
    panels.extend([
        ("Timer, idle machine", trials(false, |trial| &trial.timer)),
        (
            "Timer, a busy thread on every core",
            trials(true, |trial| &trial.timer),
        ),
        (
            "Wake-up, idle machine",
            trials(false, |trial| &trial.wake_up),
        ),
        (
            "Wake-up, a busy thread on every core",
            trials(true, |trial| &trial.wake_up),
        ),
    ]);
    let diagrams: Vec<Diagram<'_>> = panels
        .iter()
        .map(|(title, series)| diagram(title, series))
        .collect();
    in_columns(&diagrams, 2)
}

fn of_probes<'a>(probes: &[&'a Samples]) -> Vec<Series<'a>> {
    let series = probes.iter().enumerate().map(|(index, samples)| Series {
        name: samples.name.clone(),
        color: COLORS[index % COLORS.len()],
        values_ns: Cow::Borrowed(&samples.values_ns),
    });
    series.collect()
}

/// Colour of the baseline curve.
fn of_trials(
    trials: &[SettingTrial],
    is_loaded: bool,
    probe: fn(&SettingTrial) -> &Samples,
) -> Vec<Series<'static>> {
    let mut series: Vec<Series<'static>> = Vec::new();
    for trial in trials.iter().filter(|trial| trial.is_loaded == is_loaded) {
        let name = trial.setting.name();
        let values_ns = &probe(trial).values_ns;
        if let Some(known) = series.iter_mut().find(|series| series.name == name) {
            known.values_ns.to_mut().extend_from_slice(values_ns);
        } else {
            let color = match trial.setting {
                ThreadSetting::Baseline => BASELINE_COLOR,
                _ => COLORS[series.len() % COLORS.len()],
            };
            series.push(Series {
                name: name.to_owned(),
                color,
                values_ns: Cow::Owned(values_ns.clone()),
            });
        }
    }
    series
}

fn diagram<'a>(title: &'a str, series: &'a [Series<'_>]) -> Diagram<'a> {
    let all = || series.iter().flat_map(|series| series.values_ns.iter());
    let whole_decades = |bin: i32| bin.div_euclid(BINS_PER_DECADE) * BINS_PER_DECADE;
    let first = whole_decades(bin(all().min().copied().unwrap_or(1_000)));
    let last = whole_decades(bin(all().max().copied().unwrap_or(1_000))) + BINS_PER_DECADE;
    let curves = series.iter().map(|series| Curve {
        name: &series.name,
        color: series.color,
        points: steps(&series.values_ns, first, last),
        is_marked: false,
    });
    let curves: Vec<Curve<'_>> = curves.collect();
    let points = curves.iter().flat_map(|curve| &curve.points);
    let highest = points.map(|(_, count)| *count).fold(1.0, f64::max);
    Diagram {
        title,
        x: Axis::logarithmic("µs", edge_us(first)..edge_us(last)),
        y: Axis::logarithmic("samples", EMPTY..3.0 * highest),
        curves,
        legend: Legend::UpperRight,
    }
}

/// Index of a value's logarithmic bin; bin 0 starts at 1 ns.
fn bin(value_ns: u64) -> i32 {
    (f64::from(BINS_PER_DECADE) * (value_ns.max(1) as f64).log10()).floor() as i32
}

/// Lower edge of a histogram bin, µs.
fn edge_us(bin: i32) -> f64 {
    10_f64.powf(f64::from(bin) / f64::from(BINS_PER_DECADE)) / 1000.0
}

/// Outline of the histogram over the bins `first..last`.
fn steps(values_ns: &[u64], first: i32, last: i32) -> Vec<(f64, f64)> {
    let mut counts = vec![0_u64; usize::try_from(last - first).unwrap_or(0)];
    for value_ns in values_ns {
        let index = usize::try_from(bin(*value_ns) - first);
        if let Some(count) = index.ok().and_then(|index| counts.get_mut(index)) {
            *count += 1;
        }
    }
    let steps = counts.iter().zip(first..).flat_map(|(count, bin)| {
        let height = (*count as f64).max(EMPTY);
        [(edge_us(bin), height), (edge_us(bin + 1), height)]
    });
    steps.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_step_is_as_high_as_its_bin_has_values() {
        let values = [1_000, 1_001, 10_000];
        let (first, last) = (bin(1_000), bin(10_000) + 1);
        let outline = steps(&values, first, last);
        assert_eq!(outline.len(), 2 * 21);
        assert_eq!(
            (outline[0].1, outline[2].1, outline[40].1),
            (2.0, EMPTY, 1.0)
        );
        assert!((outline[0].0 - 1.0).abs() < 1e-9 && (outline[40].0 - 10.0).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn histogram_counts_every_value(values in prop::collection::vec(any::<u64>(), 1..50)) {
            let first = bin(*values.iter().min().unwrap());
            let last = bin(*values.iter().max().unwrap()) + 1;
            let outline = steps(&values, first, last);
            let heights = outline.iter().step_by(2).map(|(_, height)| *height);
            let n: f64 = heights.filter(|height| *height >= 1.0).sum();
            prop_assert_eq!(n as usize, values.len());
        }
    }
}
