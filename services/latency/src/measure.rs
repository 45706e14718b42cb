//! `tabula latency`: measures frame latencies.

use crate::arguments::MeasureArguments;
use crate::conditions::ConditionsMonitor;
use crate::daemon_under_test::DaemonUnderTest;
use crate::report_text;
use crate::results::{self, AcceptanceCriteria};
use crate::trace_reader::{ReadEnd, TraceReader, no_frames};
use command_line::{Output, StopSignal, progress_bar};
use latency_report::{LatencyRecorder, LatencyReport, MeasurementOverhead};
use message::Stage;
use service::{CommonArguments, Failure, Stopwatch, exit_code};
use statistics::percentiles::nearest_rank;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// Laps per timed round, and number of rounds, for the cost of a stopwatch lap; the median round
/// counts.
const N_LAPS: u32 = 1000;
const N_ROUNDS: usize = 21;

/// Measures, prints and writes the report; the exit code tells whether limits were kept.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &MeasureArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    // The budget and the baseline are read first: a wrong file should not cost a minute.
    let criteria = AcceptanceCriteria::prepare(arguments)?;
    let stop = StopSignal::install()?;
    let daemon = DaemonUnderTest::choose(common, &arguments.source, output)?;
    let (report, recorder) = measure(&daemon, arguments, &stop, output)?;
    drop(daemon);
    if let Some(folder) = &arguments.out {
        results::write(folder, &report, &recorder)?;
    }
    let acceptance = &criteria.judge(&report);
    let document = results::ReportDocument {
        report: &report,
        acceptance,
    };
    output.answer(&document, || {
        let written = arguments.out.as_ref();
        let written = written.map(|folder| format!("\nwritten to {}", folder.display()));
        report_text::text(&report)
            + &report_text::acceptance(acceptance)
            + &written.unwrap_or_default()
    });
    Ok(exit_code(&report, acceptance))
}

/// Exit code: failure if the consistency check fails, over budget if a limit is exceeded.
fn exit_code(report: &LatencyReport, acceptance: &results::AcceptanceResult) -> ExitCode {
    if report.sum_check.passes() {
        results::exit_code(acceptance.is_over())
    } else {
        ExitCode::from(exit_code::FAILURE)
    }
}

/// Measures until enough frames have arrived, the daemon is silent, or a stop is requested.
pub(crate) fn measure(
    daemon: &DaemonUnderTest,
    arguments: &MeasureArguments,
    stop: &StopSignal,
    output: &Output,
) -> Result<(LatencyReport, LatencyRecorder), Failure> {
    let mut trace_reader = TraceReader::new(&daemon.domain)?;
    let mut recorder = LatencyRecorder::new(arguments.timeline as usize);
    let monitor = warm_up(&mut trace_reader, arguments.warm_up, stop)?;
    let progress = progress_bar(arguments.frames, "frames", output);
    trace_reader.each_frame(stop, |timeline| {
        recorder.add(timeline);
        let n_frames = recorder.n_frames() as u64;
        progress.set_position(n_frames);
        n_frames < arguments.frames
    })?;
    progress.finish_and_clear();
    if recorder.n_frames() == 0 {
        return Err(no_frames());
    }
    let conditions = monitor.end(
        source_name(daemon, arguments),
        &daemon.domain,
        &trace_reader,
    );
    let overhead = MeasurementOverhead {
        stage_cost_ns: stage_cost_ns(),
        left_out: trace_reader.assembler().n_left_out(),
        unknown: trace_reader.assembler().n_unknown(),
        ..MeasurementOverhead::default()
    };
    Ok((
        LatencyReport::new(&recorder, &overhead, conditions),
        recorder,
    ))
}

/// Skips the warm-up frames.
fn warm_up(
    trace_reader: &mut TraceReader,
    n_frames: u64,
    stop: &StopSignal,
) -> Result<ConditionsMonitor, Failure> {
    let mut n_passed = 0;
    let ended = trace_reader.each_frame(stop, |_| {
        n_passed += 1;
        n_passed <= n_frames
    })?;
    match ended {
        ReadEnd::Enough => Ok(ConditionsMonitor::begin(trace_reader)),
        ReadEnd::Silence => Err(no_frames()),
    }
}

fn source_name(daemon: &DaemonUnderTest, arguments: &MeasureArguments) -> String {
    if daemon.is_own() {
        let source = &arguments.source;
        source.source.clone().unwrap_or_else(|| "simulation".into())
    } else {
        format!("the daemon of the domain {}", daemon.domain.name())
    }
}

/// Cost of measuring one stage on this computer, nanoseconds: median over rounds.
fn stage_cost_ns() -> f64 {
    let mut rounds_ns = [0; N_ROUNDS];
    for round_ns in &mut rounds_ns {
        let mut watch = Stopwatch::start();
        let begun = Instant::now();
        for _ in 0..N_LAPS {
            black_box(watch.lap(Stage::Samples, 0));
        }
        *round_ns = begun.elapsed().as_nanos();
    }
    rounds_ns.sort_unstable();
    let median_ns = nearest_rank(&rounds_ns, 0.5).unwrap_or_default();
    median_ns as f64 / f64::from(N_LAPS)
}
