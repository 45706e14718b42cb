//! Soak test analysis: detects growth of memory, files and latency over a long run.

use crate::duration_percentiles::DurationPercentiles;
use crate::report::ProcessReport;
use plot::DrawingError;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, in_columns};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Tolerated growth of resident memory from the second quarter to the last: relative share, or
/// megabytes if that is more. Chosen: allocators keep freed memory, and slots of shared memory
/// count as resident only after first use.
const MEMORY_GROWTH_SHARE: f64 = 0.05;
const MEMORY_GROWTH_MB: f64 = 2.0;
/// Tolerated growth of the number of open files. Chosen: the database creates tables and merges
/// them again.
const OPEN_FILES_GROWTH: f64 = 3.0;
/// Tolerated ratio of the p99 latency in the last quarter to that in the second. Chosen.
const LATENCY_RATIO_MAX: f64 = 1.5;
/// Tolerated drift of the wall clock against the monotonic clock, parts per million: clock
/// discipline adjusts by less than 500.
const DRIFT_PPM_MAX: f64 = 500.0;

/// Statistics of one window of a soak run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SoakWindow {
    /// End of the window since the start of the run, seconds.
    pub at_s: f64,
    /// Number of scheduled captures (frames that were due).
    pub frames: u64,
    /// Captured frames without labels.
    pub dropped: u64,
    /// Scheduled captures without a frame from the source.
    pub not_captured: u64,
    /// Latency from scheduled capture to published labels.
    pub end_to_end_ms: DurationPercentiles,
    /// Processes at the end of the window, with their usage within it.
    pub processes: Vec<ProcessReport>,
    /// Shared memory used by the domain, bytes.
    pub shared_memory_bytes: u64,
    /// Wall clock minus monotonic clock, relative to the start of the run, nanoseconds.
    pub clock_drift_ns: i64,
}

/// Detected growth or drift.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    /// Description of the growth as one sentence.
    pub sentence: String,
}

/// Compares the last quarter of the run with the second; the first is warm-up. Returns nothing
/// for fewer than eight windows.
pub fn find_growth(windows: &[SoakWindow]) -> Vec<Growth> {
    let quarter = windows.len() / 4;
    if quarter < 2 {
        return Vec::new();
    }
    let (before, last) = (&windows[quarter..2 * quarter], &windows[3 * quarter..]);
    let mut sentences = Vec::new();
    for process in names(windows) {
        let memory = |part| mean(part, |w| of(w, &process).map(|p| p.resident_mb));
        let (then, now) = (memory(before), memory(last));
        if has_grown(then, now) {
            sentences.push(format!(
                "{process} has grown from {then:.1} to {now:.1} MB of resident memory"
            ));
        }
        let files = |part| mean(part, |w| of(w, &process).map(|p| p.open_files as f64));
        let (then, now) = (files(before), files(last));
        if now > then + OPEN_FILES_GROWTH {
            sentences.push(format!(
                "{process} has {now:.0} files open, {then:.0} before"
            ));
        }
    }
    let memory = |part| mean(part, |w| Some(w.shared_memory_bytes as f64 / 1e6));
    let (then, now) = (memory(before), memory(last));
    if has_grown(then, now) {
        sentences.push(format!(
            "the domain has grown from {then:.1} to {now:.1} MB of shared memory"
        ));
    }
    let slow = |part| mean(part, |w| Some(w.end_to_end_ms.p99));
    let (then, now) = (slow(before), slow(last));
    if now > LATENCY_RATIO_MAX * then {
        sentences.push(format!("the p99 has grown from {then:.2} to {now:.2} ms"));
    }
    sentences.extend(drift(windows));
    sentences
        .into_iter()
        .map(|sentence| Growth { sentence })
        .collect()
}

/// `true` if memory (megabytes) has grown beyond the tolerance.
fn has_grown(then: f64, now: f64) -> bool {
    now - then > MEMORY_GROWTH_MB.max(MEMORY_GROWTH_SHARE * then)
}

fn drift(windows: &[SoakWindow]) -> Option<String> {
    let last = windows.last()?;
    let ppm = last.clock_drift_ns as f64 / (last.at_s * 1e3).max(1.0);
    (ppm.abs() > DRIFT_PPM_MAX).then(|| {
        format!(
            "wall clock and monotonic clock have drifted apart by {:.1} ms, {ppm:.0} parts of a \
             million",
            last.clock_drift_ns as f64 / 1e6
        )
    })
}

fn names(windows: &[SoakWindow]) -> BTreeSet<String> {
    let processes = windows.iter().flat_map(|window| &window.processes);
    processes.map(|process| process.process.clone()).collect()
}

fn of<'a>(window: &'a SoakWindow, name: &str) -> Option<&'a ProcessReport> {
    let mut processes = window.processes.iter();
    processes.find(|process| process.process == name)
}

fn mean(part: &[SoakWindow], figure: impl Fn(&SoakWindow) -> Option<f64>) -> f64 {
    let figures: Vec<f64> = part.iter().filter_map(figure).collect();
    figures.iter().sum::<f64>() / figures.len().max(1) as f64
}

/// Latency, resident memory, open files and shared memory over time.
///
/// # Errors
/// If the plotting library fails.
pub fn soak_figure(windows: &[SoakWindow]) -> Result<String, DrawingError> {
    let names: Vec<String> = names(windows).into_iter().collect();
    let of_processes = |figure: fn(&ProcessReport) -> f64| {
        let processes = names.iter().enumerate();
        let curves = processes.map(|(index, name)| {
            let figure = |window: &SoakWindow| of(window, name).map(figure);
            over_time(windows, name, index, figure)
        });
        curves.collect::<Vec<_>>()
    };
    let latency = DurationPercentiles::NAMED.iter().enumerate();
    let latency = latency.map(|(index, (name, get))| {
        over_time(windows, name, index, |window| {
            Some(get(&window.end_to_end_ms))
        })
    });
    let shared_mb = |window: &SoakWindow| Some(window.shared_memory_bytes as f64 / 1e6);
    let shared = over_time(windows, "", 0, shared_mb);
    in_columns(
        &[
            diagram("End to end", "ms", latency.collect()),
            diagram("Resident memory", "MB", of_processes(|p| p.resident_mb)),
            diagram("Open files", "files", of_processes(|p| p.open_files as f64)),
            diagram("Shared memory", "MB", vec![shared]),
        ],
        2,
    )
}

/// Curve over the windows that have a value: the first window may not know the processes yet.
fn over_time<'a>(
    windows: &[SoakWindow],
    name: &'a str,
    index: usize,
    figure: impl Fn(&SoakWindow) -> Option<f64>,
) -> Curve<'a> {
    let point = |window: &SoakWindow| Some((window.at_s / 60.0, figure(window)?));
    Curve::line(
        name,
        Color::of_series(index),
        windows.iter().filter_map(point),
    )
}

fn diagram<'a>(title: &'a str, unit: &'a str, curves: Vec<Curve<'a>>) -> Diagram<'a> {
    let all = || curves.iter().flat_map(|curve| &curve.points);
    let last = all().map(|point| point.0).fold(0.0, f64::max);
    let most = all().map(|point| point.1).fold(0.0, f64::max);
    Diagram {
        title,
        x: Axis::linear("minutes", 0.0..last.max(0.01)),
        // Space for the legend.
        y: Axis::linear(unit, 0.0..most.max(0.001) * 1.5),
        curves,
        legend: Legend::UpperLeft,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Soak run of 40 windows of 10 s.
    fn windows(change: impl Fn(usize, &mut SoakWindow)) -> Vec<SoakWindow> {
        let window = |i: usize| {
            let mut window = SoakWindow {
                at_s: 10.0 * (i + 1) as f64,
                frames: 1200,
                shared_memory_bytes: 10_000_000,
                processes: vec![ProcessReport {
                    process: "perception".into(),
                    resident_mb: 30.0,
                    open_files: 150,
                    ..ProcessReport::default()
                }],
                end_to_end_ms: DurationPercentiles {
                    p99: 9.0 + (i % 3) as f64,
                    ..DurationPercentiles::default()
                },
                ..SoakWindow::default()
            };
            change(i, &mut window);
            window
        };
        (0..40).map(window).collect()
    }

    fn changes_found(change: impl Fn(usize, &mut SoakWindow)) -> Vec<String> {
        let grown = find_growth(&windows(change));
        grown.into_iter().map(|growth| growth.sentence).collect()
    }

    #[test]
    fn constant_windows_show_no_growth() {
        assert_eq!(changes_found(|_, _| ()), Vec::<String>::new());
        let warming = |i: usize, w: &mut SoakWindow| {
            w.processes[0].resident_mb = if i < 8 { 20.0 } else { 30.0 };
        };
        assert_eq!(changes_found(warming), Vec::<String>::new());
        assert!(find_growth(&[]).is_empty());
    }

    #[test]
    fn growth_of_each_kind_is_found() {
        let check = |change: &dyn Fn(usize, &mut SoakWindow), word: &str| {
            let sentences = changes_found(change);
            assert!(
                sentences.len() == 1 && sentences[0].contains(word),
                "{sentences:?}"
            );
        };
        check(
            &|i, w| w.processes[0].resident_mb += i as f64 * 0.2,
            "resident",
        );
        check(&|i, w| w.processes[0].open_files += i as u64 / 4, "files");
        check(
            &|i, w| w.shared_memory_bytes += i as u64 * 200_000,
            "shared memory",
        );
        check(&|i, w| w.end_to_end_ms.p99 += i as f64, "p99");
        check(&|i, w| w.clock_drift_ns = i as i64 * 10_000_000, "drifted");
    }

    #[test]
    fn a_run_is_drawn() {
        let picture = soak_figure(&windows(|_, _| ())).unwrap();
        assert!(picture.contains("perception") && picture.contains("Shared memory"));
        assert!(soak_figure(&[]).is_ok());
    }
}
