//! `tabula latency`: measures frame latencies.

use crate::arguments::MeasureArguments;
use crate::chosen_daemon::ChosenDaemon;
use crate::conditions::ConditionsWatch;
use crate::listener::{Ended, Listener, no_frames};
use crate::report_text;
use crate::results::{self, Judged};
use command_line::{Output, StopSignal, bar};
use latency_report::{Measurement, Measuring, Report};
use message::Stage;
use service::{CommonArguments, Failure, Stopwatch, exit_code};
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
    let judged = Judged::prepare(arguments)?;
    let stop = StopSignal::install()?;
    let daemon = ChosenDaemon::choose(common, &arguments.source, output)?;
    let (report, measurement) = measure(&daemon, arguments, &stop, output)?;
    drop(daemon);
    if let Some(folder) = &arguments.out {
        results::write(folder, &report, &measurement)?;
    }
    let judgement = judged.judge(&report);
    output.answer(&results::Document::new(&report, &judgement), || {
        let written = arguments.out.as_ref();
        let written = written.map(|folder| format!("\nwritten to {}", folder.display()));
        report_text::text(&report)
            + &report_text::judgement(&judgement)
            + &written.unwrap_or_default()
    });
    Ok(exit_code(&report, &judgement))
}

/// Exit code: failure if the consistency check fails, over budget if a limit is exceeded.
fn exit_code(report: &Report, judgement: &results::Judgement) -> ExitCode {
    if !report.sum_check.passes() {
        ExitCode::from(exit_code::FAILURE)
    } else if judgement.is_over() {
        ExitCode::from(exit_code::OVER_BUDGET)
    } else {
        ExitCode::SUCCESS
    }
}

/// Measures until enough frames have arrived, the daemon is silent, or a stop is requested.
pub(crate) fn measure(
    daemon: &ChosenDaemon,
    arguments: &MeasureArguments,
    stop: &StopSignal,
    output: &Output,
) -> Result<(Report, Measurement), Failure> {
    let mut listener = Listener::new(&daemon.domain)?;
    let mut measurement = Measurement::new(arguments.timeline as usize);
    let watch = warm_up(&mut listener, arguments.warm_up, stop)?;
    let progress = bar(arguments.frames, "frames", output);
    listener.each_frame(stop, |way| {
        measurement.add(way);
        let n_frames = measurement.n_frames() as u64;
        progress.set_position(n_frames);
        n_frames < arguments.frames
    })?;
    progress.finish_and_clear();
    if measurement.n_frames() == 0 {
        return Err(no_frames());
    }
    let conditions = watch.end(
        source_name(daemon, arguments),
        daemon.domain.name(),
        &listener,
    );
    let measuring = Measuring {
        stage_cost_ns: stage_cost_ns(),
        left_out: listener.gathering().n_left_out(),
        unknown: listener.gathering().n_unknown(),
        ..Measuring::default()
    };
    Ok((
        Report::new(&measurement, &measuring, conditions),
        measurement,
    ))
}

/// Skips the warm-up frames.
fn warm_up(
    listener: &mut Listener,
    n_frames: u64,
    stop: &StopSignal,
) -> Result<ConditionsWatch, Failure> {
    let mut n_passed = 0;
    let ended = listener.each_frame(stop, |_| {
        n_passed += 1;
        n_passed <= n_frames
    })?;
    match ended {
        Ended::Enough => Ok(ConditionsWatch::begin(listener)),
        Ended::Silence => Err(no_frames()),
    }
}

fn source_name(daemon: &ChosenDaemon, arguments: &MeasureArguments) -> String {
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
    rounds_ns[N_ROUNDS / 2] as f64 / f64::from(N_LAPS)
}
