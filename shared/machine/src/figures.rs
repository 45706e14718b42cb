//! Latencies as figures.

use crate::measurement::MachineReport;
use crate::samples::Samples;
use crate::trial::{Setting, Trial};
use evaluation::DrawingError;
use evaluation::figure::{Axis, Color, Curve, Diagram, Legend, in_columns};

/// Bins of a factor of ten.
const BINS_PER_DECADE: f64 = 20.0;
/// Where an empty bin is drawn, so that a count of 1 is seen.
const EMPTY: f64 = 0.5;

/// Name in the legend, and values.
type Series<'a> = (String, &'a [u64]);

/// Histograms of all latencies as SVG, log count over log µs (after cyclictest's
/// plots): the probes and the gaps, and timer and wake-up under each setting, idle and busy.
///
/// # Errors
/// When the drawing library fails.
pub fn histograms(report: &MachineReport) -> Result<String, DrawingError> {
    let of_samples = |samples: &'_ Samples| samples.name.clone();
    let mut probes: Vec<Series<'_>> = report
        .latencies
        .iter()
        .map(|samples| (of_samples(samples), samples.values_ns.as_slice()))
        .collect();
    let hops = probes.split_off(probes.partition_point(|(name, _)| !name.starts_with("hop")));
    let gaps = &report.interruptions.gaps;
    probes.push((of_samples(gaps), &gaps.values_ns));
    let mut panels = vec![
        ("Noise of this machine", probes),
        ("Hops through shared memory", hops),
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

/// The trials of one probe; the second one as it is says how much they vary.
fn of_trials(trials: &[Trial], is_loaded: bool, probe: fn(&Trial) -> &Samples) -> Vec<Series<'_>> {
    let mut n_as_is = 0;
    let chosen = trials.iter().filter(|trial| trial.is_loaded == is_loaded);
    let series = chosen.map(|trial| {
        n_as_is += usize::from(trial.setting == Setting::AsIs);
        let is_again = trial.setting == Setting::AsIs && n_as_is > 1;
        let name = trial.setting.name();
        let name = if is_again {
            format!("{name}, again")
        } else {
            name.to_owned()
        };
        (name, probe(trial).values_ns.as_slice())
    });
    series.collect()
}

fn diagram<'a>(title: &'a str, series: &'a [Series<'_>]) -> Diagram<'a> {
    let all = || series.iter().flat_map(|(_, values)| values.iter().copied());
    let first = bin(all().min().unwrap_or(1_000));
    let last = bin(all().max().unwrap_or(1_000)) + 1;
    let histograms: Vec<Vec<(f64, f64)>> = series
        .iter()
        .map(|(_, values)| steps(values, first, last))
        .collect();
    let points = histograms.iter().flatten();
    let highest = points.map(|(_, count)| *count).fold(1.0, f64::max);
    let named = series.iter().zip(histograms).enumerate();
    let curves = named.map(|(index, ((name, _), points))| Curve {
        name,
        color: Color::of_series(index),
        points,
        is_marked: false,
    });
    Diagram {
        title,
        x: Axis::logarithmic("µs", edge_us(first)..edge_us(last)),
        y: Axis::logarithmic("samples", EMPTY..3.0 * highest),
        curves: curves.collect(),
        legend: Legend::UpperRight,
    }
}

/// Number of a value's bin; 0 begins at 1 ns.
fn bin(value_ns: u64) -> i32 {
    (BINS_PER_DECADE * (value_ns.max(1) as f64).log10()).floor() as i32
}

/// Where a bin begins, µs.
fn edge_us(bin: i32) -> f64 {
    10_f64.powf(f64::from(bin) / BINS_PER_DECADE) / 1000.0
}

/// The outline of a histogram over the bins from `first` up to `last`.
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
        fn no_value_is_lost(values in prop::collection::vec(any::<u64>(), 1..50)) {
            let first = bin(*values.iter().min().unwrap());
            let last = bin(*values.iter().max().unwrap()) + 1;
            let outline = steps(&values, first, last);
            let heights = outline.iter().step_by(2).map(|(_, height)| *height);
            let n: f64 = heights.filter(|height| *height >= 1.0).sum();
            prop_assert_eq!(n as usize, values.len());
        }
    }
}
