//! `tabula latency stop`: time from a stop to the braking of the simulated arm, under conditions.

mod condition;
mod figure;
mod moving_arm;
mod trial;

use crate::arguments::StopArguments;
use crate::measured_daemon::MeasuredDaemon;
use crate::results::{exit_code, not_written, write_with_figure};
use command_line::{Output, StopSignal, format_table, progress_bar};
pub(crate) use condition::StopCondition;
use condition::{ConditionGuard, Unavailable};
use latency_report::DurationPercentiles;
use moving_arm::MovingArm;
use serde::Serialize;
use service::Failure;
use std::process::ExitCode;
use system_noise::{WakeUpDelay, WakeUpDelayMonitor};
use trial::{StopTrial, measure_stop};

/// Scene of the daemon: an arm beside a table with one object, and nobody who is in its way.
const SCENE: &str = "[arm]\n[[object]]\ncategory = 'mug'\nposition_m = [0.2, 0.1]\n";
/// Configuration of the daemon: no process is ended for a lack of progress.
const PATIENT: &str =
    "[run]\nwatchdog_s = 3600.0\nmemory_watchdog_s = 3600.0\nstartup_watchdog_s = 3600.0\n";
/// Time to the beginning of braking above which the exit code tells of it, ms.
const LIMIT_MS: f64 = 250.0;

/// Times of all stops under one condition.
#[derive(Debug, Serialize)]
struct ConditionRow {
    condition: StopCondition,
    /// Reason for which nothing was measured here.
    skipped: Option<String>,
    n_stops: usize,
    /// Number of stops on which the arm's loop has not acted within a second.
    n_lost: usize,
    /// From the write of the stop word to the beginning of braking.
    braking_ms: DurationPercentiles,
    /// From the write of the stop word until all joints are below 0.01 rad/s.
    rest_ms: DurationPercentiles,
    /// Delay of a thread that sleeps a millisecond at a time meanwhile: the noise of the machine.
    noise: WakeUpDelay,
    #[serde(skip)]
    trials: Vec<StopTrial>,
}

/// JSON document of the measurement.
#[derive(Serialize)]
struct StopDocument {
    is_real_time: bool,
    conditions: Vec<ConditionRow>,
}

/// Measures condition by condition; exit code 7 when the arm brakes too late, or not at all.
pub(crate) fn run(arguments: &StopArguments, output: &Output) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install()?;
    let conditions = match arguments.conditions.as_slice() {
        [] => StopCondition::ALL.to_vec(),
        chosen => chosen.to_vec(),
    };
    let mut rows = Vec::new();
    for condition in conditions {
        if stop.is_raised() {
            break;
        }
        output.print_status(&format!("stops: {}", condition.title()));
        rows.push(measure(arguments, condition, &stop, output)?);
    }
    let document = StopDocument {
        is_real_time: !arguments.without_real_time,
        conditions: rows,
    };
    if let Some(folder) = &arguments.out {
        let drawn = figure::figure(&document.conditions);
        write_with_figure(folder, "stop", &document, drawn)?;
    }
    output.answer(&document, || text(&document));
    let is_late = |row: &ConditionRow| row.braking_ms.max > LIMIT_MS || row.n_lost > 0;
    Ok(exit_code(document.conditions.iter().any(is_late)))
}

fn measure(
    arguments: &StopArguments,
    condition: StopCondition,
    stop: &StopSignal,
    output: &Output,
) -> Result<ConditionRow, Failure> {
    let n_wanted = condition.n_stops(arguments.stops);
    let progress = progress_bar(n_wanted as u64, "stops", output);
    let noise = WakeUpDelayMonitor::begin();
    let mut trials = Vec::new();
    let mut skipped = None;
    let mut started = None;
    while trials.len() < n_wanted && !stop.is_raised() && skipped.is_none() {
        let (guard, arm) = match started.take() {
            Some(started) => started,
            None => match start(arguments, condition) {
                Ok(started) => started,
                Err(Unavailable::Here(reason)) => {
                    skipped = Some(reason);
                    continue;
                }
                Err(Unavailable::Failed(failure)) => return Err(failure),
            },
        };
        trials.push(measure_stop(&arm, &guard, trials.len())?);
        progress.set_position(trials.len() as u64);
        if !condition.ends_the_daemon() {
            started = Some((guard, arm));
        }
    }
    progress.finish_and_clear();
    if let Some(reason) = &skipped {
        output.print_status(&format!("SKIPPED: {}: {reason}", condition.title()));
    }
    Ok(row(condition, skipped, trials, noise.end()))
}

/// Starts a daemon with a moving arm, and brings the condition about. The guard comes first, since it
/// must be dropped first: a daemon whose disk is frozen cannot end.
fn start(
    arguments: &StopArguments,
    condition: StopCondition,
) -> Result<(ConditionGuard, MovingArm), Unavailable> {
    let home = MeasuredDaemon::home()?;
    let disk = condition.mount_disk(home.path())?;
    let write = |name: &str, text: &str| {
        let path = home.path().join(name);
        dataset::write_atomic(&path, text).map_err(not_written)?;
        Ok::<_, Failure>(path)
    };
    let scene = write("scene.toml", SCENE)?;
    let real_time = !arguments.without_real_time;
    let own = format!("{PATIENT}[simulator]\nreal_time = {real_time}\n");
    let config = write("stop.toml", &own)?;
    let words = [
        format!("--source=simulation:{}", scene.display()),
        format!("--config={}", config.display()),
    ];
    let daemon = MeasuredDaemon::start(home, &words, None)?;
    let arm = MovingArm::new(daemon)?;
    let guard = ConditionGuard::begin(condition, &arm, &config, disk)?;
    Ok((guard, arm))
}

fn row(
    condition: StopCondition,
    skipped: Option<String>,
    trials: Vec<StopTrial>,
    noise: WakeUpDelay,
) -> ConditionRow {
    let times = |time: fn(&StopTrial) -> Option<u64>| {
        let mut times: Vec<u64> = trials.iter().filter_map(time).collect();
        DurationPercentiles::of(&mut times)
    };
    ConditionRow {
        condition,
        skipped,
        n_stops: trials.len(),
        n_lost: trials
            .iter()
            .filter(|trial| trial.braking_ns.is_none())
            .count(),
        braking_ms: times(|trial| trial.braking_ns),
        rest_ms: times(|trial| trial.rest_ns),
        noise,
        trials,
    }
}

fn text(document: &StopDocument) -> String {
    let heading = [
        "condition",
        "stops",
        "lost",
        "braking p50 ms",
        "p99",
        "max",
        "at rest p50 ms",
        "p99",
        "max",
        "machine p99 ms",
        "max",
    ];
    let rows: Vec<Vec<String>> = document.conditions.iter().map(cells).collect();
    let real_time = if document.is_real_time {
        "with real-time priority where the system allows it"
    } else {
        "without real-time priority"
    };
    format!(
        "{}\nthe arm's loop runs {real_time}; goals: braking p99 50 ms, max 100 ms",
        format_table(&heading, &rows)
    )
}

fn cells(row: &ConditionRow) -> Vec<String> {
    let mut cells = vec![row.condition.title().to_owned()];
    if row.skipped.is_some() {
        cells.push("SKIPPED".to_owned());
        cells.resize(11, String::new());
        return cells;
    }
    cells.extend([row.n_stops, row.n_lost].map(|n| n.to_string()));
    for times in [&row.braking_ms, &row.rest_ms] {
        cells.extend([times.p50, times.p99, times.max].map(|ms| format!("{ms:.1}")));
    }
    cells.extend([row.noise.p99_ms, row.noise.max_ms].map(|ms| format!("{ms:.1}")));
    cells
}
