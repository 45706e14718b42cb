//! `tabula latency sweep`: parameter sweep, with a daemon of its own for each value.

mod box_scene;
mod operating_point;
mod stored_views;

use crate::arguments::{MeasureArguments, SourceArguments, SweepArguments};
use crate::daemon_under_test::DaemonUnderTest;
use crate::measure::measure;
use crate::measured_daemon::MeasuredDaemon;
use crate::results::{not_written, write_with_figure};
use crate::sweep_axis::SweepAxis;
use channel::topic::Scene;
use channel::{SharedMessage, Subscriber};
use command_line::{Output, StopSignal, format_table};
use latency_report::{SweepRow, sweep_figure};
use operating_point::{OperatingPoint, operating_points};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Maximum time until perception knows the taught views.
const KNOWN_TIMEOUT: Duration = Duration::from_secs(60);
const POLL_PERIOD: Duration = Duration::from_millis(100);

/// JSON document of a sweep.
#[derive(Serialize)]
struct SweepDocument<'a> {
    axis: &'a str,
    rows: &'a [SweepRow],
}

/// Measures value by value; a frame rate that the daemon does not sustain ends the sweep.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &SweepArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let axis = arguments.axis;
    let stop = StopSignal::install()?;
    let mut rows = Vec::new();
    for point in operating_points(axis, &arguments.values)? {
        output.print_status(&format!("{} {}", axis.title(), point.value));
        let row = measure_at(&point, common.config.as_deref(), arguments, &stop, output)?;
        let is_end = stop.is_raised() || (axis == SweepAxis::Rate && row.is_overloaded());
        rows.push(row);
        if is_end {
            break;
        }
    }
    if let Some(folder) = &arguments.out {
        let figure = sweep_figure(axis.title(), &rows);
        write_with_figure(folder, &format!("sweep-{}", axis.word()), &rows, figure)?;
    }
    let document = SweepDocument {
        axis: axis.title(),
        rows: &rows,
    };
    output.answer(&document, || text(axis, &rows));
    Ok(ExitCode::SUCCESS)
}

fn measure_at(
    point: &OperatingPoint,
    config: Option<&Path>,
    arguments: &SweepArguments,
    stop: &StopSignal,
    output: &Output,
) -> Result<SweepRow, Failure> {
    let home = MeasuredDaemon::home()?;
    let (source, n_views) = prepare(point, &home)?;
    let daemon = DaemonUnderTest::start(home, &source.run_arguments(config), point.n_cores)?;
    wait_until_known(&daemon, n_views, stop)?;
    let plan = MeasureArguments {
        source,
        frames: arguments.frames,
        timeline: 0,
        ..MeasureArguments::default()
    };
    let (report, _) = measure(&daemon, &plan, stop, output)?;
    let value = match arguments.axis {
        SweepAxis::Points => mean_points(&daemon, stop)?.unwrap_or(point.value),
        _ => point.value,
    };
    Ok(SweepRow::new(value, &report))
}

/// Prepares the daemon's home for a sweep point; returns its source and the memory sequence that
/// perception must have reached.
fn prepare(point: &OperatingPoint, home: &TempDir) -> Result<(SourceArguments, u64), Failure> {
    let sequence = match point.n_views {
        0 => 0,
        n_views => stored_views::store(home.path(), n_views)?,
    };
    let mut source = point.source.clone();
    if let Some(side_m) = point.box_side_m {
        let scene = box_scene::write(home.path(), side_m).map_err(not_written)?;
        source.source = Some(format!("simulation:{}", scene.display()));
    }
    Ok((source, sequence))
}

/// First value that a scene of the daemon gives; `None` when a stop is requested before.
fn first_in_scenes<T>(
    daemon: &DaemonUnderTest,
    stop: &StopSignal,
    missing: &str,
    value: impl Fn(&SharedMessage<Scene>) -> Option<T>,
) -> Result<Option<T>, Failure> {
    let mut scenes = Subscriber::<Scene>::polled(&daemon.domain)?;
    let deadline = Instant::now() + KNOWN_TIMEOUT;
    loop {
        let found = scenes.latest()?.as_ref().and_then(&value);
        if found.is_some() || stop.is_raised() {
            return Ok(found);
        }
        if Instant::now() > deadline {
            return Err(Failure::new(exit_code::TIMED_OUT, missing));
        }
        stop.sleep(POLL_PERIOD);
    }
}

/// Waits until objects are compared with all taught views.
fn wait_until_known(
    daemon: &DaemonUnderTest,
    sequence: u64,
    stop: &StopSignal,
) -> Result<(), Failure> {
    let missing = "the daemon reports no objects compared with the taught views";
    first_in_scenes(daemon, stop, missing, |scene| {
        let mut objects = scene.items().iter();
        let is_known = objects.any(|object| object.memory_sequence >= sequence);
        is_known.then_some(())
    })?;
    Ok(())
}

/// Mean number of points per object in the newest scene.
fn mean_points(daemon: &DaemonUnderTest, stop: &StopSignal) -> Result<Option<f64>, Failure> {
    let missing = "the daemon has published no scene with objects";
    first_in_scenes(daemon, stop, missing, |scene| {
        let points = scene
            .items()
            .iter()
            .map(|object| f64::from(object.n_points));
        let n = scene.items().len();
        (n > 0).then(|| points.sum::<f64>() / n as f64)
    })
}

fn text(axis: SweepAxis, rows: &[SweepRow]) -> String {
    let cells = |row: &SweepRow| {
        let median = |word: &str| {
            let median = row.stage_p50_ms.get(word);
            median.map_or("-".into(), |ms| format!("{ms:.3}"))
        };
        let ms = &row.end_to_end_ms;
        let mut cells = vec![format!("{:.0}", row.value), row.frames.to_string()];
        cells.push(format!("{} + {}", row.dropped, row.not_captured));
        cells.push(format!("{:.1}", row.objects));
        cells.extend([ms.p50, ms.p99, ms.max].map(|ms| format!("{ms:.2}")));
        cells.extend(["detection", "objects", "description", "recognition"].map(median));
        cells.push(format!("{:.2}", row.cores));
        if row.is_overloaded() {
            cells.push("the rate is not held".into());
        }
        cells
    };
    let heading = [
        axis.title(),
        "frames",
        "dropped + not captured",
        "objects",
        "p50 ms",
        "p99",
        "max",
        "detection p50",
        "objects p50",
        "description p50",
        "recognition p50",
        "cores",
        "",
    ];
    format_table(&heading, &rows.iter().map(cells).collect::<Vec<_>>())
}
