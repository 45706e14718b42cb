//! `tabula latency soak`: soak test with objects that come and go.

use crate::arguments::{SoakArguments, SourceArguments};
use crate::conditions::shared_memory;
use crate::daemon_under_test::DaemonUnderTest;
use crate::measured_daemon::MeasuredDaemon;
use crate::process_usage::ProcessUsage;
use crate::results::{exit_code, not_written, write_with_figure};
use crate::trace_reader::{ReadEnd, TraceReader, no_frames};
use command_line::{Output, StopSignal, format_table, progress_bar};
use latency_report::{
    DurationPercentiles, Growth, LatencyRecorder, ProcessReport, SoakWindow, find_growth,
    soak_figure,
};
use serde::Serialize;
use service::{CommonArguments, Failure, wall_clock_offset_ns};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

/// Number of time windows of a soak run.
const N_WINDOWS: u64 = 40;
/// Configuration of the daemon with small limits, so that intended retention does not count as
/// growth: the default limits are reached after hours, these within the first quarter of the run.
const CONFIG: &str =
    "[memory]\nworld_kept_max = 1000\nmax_unnamed_views = 200\nwrite_buffer_mb = 1\n";

/// JSON document of a soak test.
#[derive(Serialize)]
struct SoakDocument {
    frames: u64,
    dropped: u64,
    not_captured: u64,
    lost_messages: u64,
    grown: Vec<Growth>,
    windows: Vec<SoakWindow>,
}

/// Runs the soak test, prints and draws it; exit code 7 if growth was found.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &SoakArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install()?;
    let daemon = start(common.config.as_deref(), arguments, output)?;
    let (windows, lost_messages) = soak(&daemon, arguments, &stop, output)?;
    drop(daemon);
    let sum = |count: fn(&SoakWindow) -> u64| windows.iter().map(count).sum();
    let document = SoakDocument {
        frames: sum(|window| window.frames),
        dropped: sum(|window| window.dropped),
        not_captured: sum(|window| window.not_captured),
        lost_messages,
        grown: find_growth(&windows),
        windows,
    };
    if let Some(folder) = &arguments.out {
        let figure = soak_figure(&document.windows);
        write_with_figure(folder, "soak", &document, figure)?;
    }
    output.answer(&document, || text(&document));
    Ok(exit_code(!document.grown.is_empty()))
}

/// Spawns a daemon on a table with blocks that come and go.
fn start(
    config: Option<&Path>,
    arguments: &SoakArguments,
    output: &Output,
) -> Result<DaemonUnderTest, Failure> {
    let source = SourceArguments {
        rate: Some(arguments.rate),
        ..SourceArguments::of(&format!("parade:{}", arguments.objects))
    };
    let home = MeasuredDaemon::home()?;
    let little = home.path().join("soak.toml");
    if config.is_none() {
        output.print_status(&format!(
            "starting a daemon that keeps little, to be measured with its limits reached; for \
             others use --config FILE:\n{CONFIG}"
        ));
        dataset::write_atomic(&little, CONFIG).map_err(not_written)?;
    }
    let run_arguments = source.run_arguments(Some(config.unwrap_or(&little)));
    DaemonUnderTest::start(home, &run_arguments, None)
}

/// Measures window by window; returns the windows and the number of lost messages.
fn soak(
    daemon: &DaemonUnderTest,
    arguments: &SoakArguments,
    stop: &StopSignal,
    output: &Output,
) -> Result<(Vec<SoakWindow>, u64), Failure> {
    let mut trace_reader = TraceReader::new(&daemon.domain)?;
    let progress = progress_bar(arguments.frames, "frames", output);
    let (begun, offset_ns) = (Instant::now(), wall_clock_offset_ns());
    let window_frames = (arguments.frames / N_WINDOWS).max(1) as usize;
    let mut windows = Vec::new();
    let mut n_frames = 0;
    while n_frames < arguments.frames && !stop.is_raised() {
        let usages = ProcessUsage::begin_all(&trace_reader);
        let recorder = measure_window(&mut trace_reader, window_frames, stop)?;
        n_frames += recorder.n_frames() as u64;
        progress.set_position(n_frames);
        windows.push(SoakWindow {
            at_s: begun.elapsed().as_secs_f64(),
            clock_drift_ns: wall_clock_offset_ns() - offset_ns,
            shared_memory_bytes: shared_memory(&daemon.domain)
                .map_or(0, |memory| memory.used_by_domain),
            processes: usages.iter().filter_map(ProcessUsage::report).collect(),
            ..window(&recorder)
        });
    }
    progress.finish_and_clear();
    Ok((windows, trace_reader.n_lost()))
}

fn measure_window(
    trace_reader: &mut TraceReader,
    n_frames: usize,
    stop: &StopSignal,
) -> Result<LatencyRecorder, Failure> {
    let mut recorder = LatencyRecorder::new(0);
    let ended = trace_reader.each_frame(stop, |timeline| {
        recorder.add(timeline);
        recorder.n_frames() < n_frames
    })?;
    match ended {
        ReadEnd::Enough => Ok(recorder),
        ReadEnd::Silence => Err(no_frames()),
    }
}

/// Window statistics of a soak test from the recorded frames.
fn window(recorder: &LatencyRecorder) -> SoakWindow {
    let missed = recorder.missed();
    let n_missed = missed.n_dropped + missed.n_not_captured;
    SoakWindow {
        frames: recorder.n_frames() as u64 + n_missed,
        dropped: missed.n_dropped,
        not_captured: missed.n_not_captured,
        end_to_end_ms: DurationPercentiles::of(&mut recorder.end_to_end_ns(&missed)),
        ..SoakWindow::default()
    }
}

fn text(document: &SoakDocument) -> String {
    let step = document.windows.len().div_ceil(10).max(1);
    let rows: Vec<Vec<String>> = document.windows.iter().step_by(step).map(row).collect();
    let heading = [
        "minutes",
        "frames",
        "missed",
        "p50 ms",
        "p99",
        "max",
        "resident MB",
        "open files",
        "shared MB",
        "drift ms",
    ];
    let grown: Vec<String> = match document.grown.as_slice() {
        [] => vec!["nothing has grown".into()],
        grown => grown.iter().map(|growth| growth.sentence.clone()).collect(),
    };
    format!(
        "{}\n\n{} frames, {} dropped, {} not captured, {} trace messages lost\n{}",
        format_table(&heading, &rows),
        document.frames,
        document.dropped,
        document.not_captured,
        document.lost_messages,
        grown.join("\n"),
    )
}

fn row(window: &SoakWindow) -> Vec<String> {
    let of_processes = |figure: fn(&ProcessReport) -> String| -> String {
        let texts: Vec<String> = window.processes.iter().map(figure).collect();
        texts.join(" + ")
    };
    let ms = &window.end_to_end_ms;
    vec![
        format!("{:.1}", window.at_s / 60.0),
        window.frames.to_string(),
        (window.dropped + window.not_captured).to_string(),
        format!("{:.2}", ms.p50),
        format!("{:.2}", ms.p99),
        format!("{:.2}", ms.max),
        of_processes(|process| format!("{:.1}", process.resident_mb)),
        of_processes(|process| process.open_files.to_string()),
        format!("{:.2}", window.shared_memory_bytes as f64 / 1e6),
        format!("{:.3}", window.clock_drift_ns as f64 / 1e6),
    ]
}
