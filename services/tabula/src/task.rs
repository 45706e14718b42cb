//! `tabula task`: starts, follows and ends tasks of the robot.

use crate::arguments::{FetchArguments, StartArguments, TaskArgument, TaskChoice, TaskVerb};
use crate::world;
use command_line::{Output, StopSignal};
use control_client::{TrackScope, ask, ask_once, author_or_user, change, connect, mutation_id};
use control_protocol::{TaskKind, TaskOrder, TaskReport, TypedRequest, request};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code};
use std::fmt::Write;
use std::process::ExitCode;
use std::time::Duration;

/// Period of the looks at a task that is followed.
const WATCH_PERIOD: Duration = Duration::from_millis(200);

/// Runs `tabula task`.
pub(crate) fn run(
    common: &CommonArguments,
    verb: &TaskVerb,
    output: &Output,
) -> Result<ExitCode, Failure> {
    match verb {
        TaskVerb::Preview { task } => {
            let order = order(common, task)?;
            let report = ask_once(common, &request::preview_task(order))?;
            output.answer(&report, || preview_text(&report));
            Ok(ExitCode::SUCCESS)
        }
        TaskVerb::Start(start) => self::start(common, start, output),
        TaskVerb::State => {
            let report = ask_once(common, &request::task_state())?;
            output.answer(&report, || state_text(&report));
            Ok(ExitCode::SUCCESS)
        }
        TaskVerb::List { limit } => world::list_tasks(common, *limit, output),
        TaskVerb::Show(argument) => {
            let number = number(common, argument)?;
            let task = ask_once(common, &request::task(number))?;
            output.answer(&task, || world::task_text(&task));
            Ok(ExitCode::SUCCESS)
        }
        TaskVerb::Watch => watch(common, None, output),
        TaskVerb::Pause(argument) => command(common, argument, request::pause_task, output),
        TaskVerb::Resume(argument) => command(common, argument, request::resume_task, output),
        TaskVerb::Cancel(argument) => command(common, argument, request::cancel_task, output),
        TaskVerb::Graph { task } => {
            let document = GraphDocument {
                task: task.clone(),
                mermaid: tasks::mermaid(),
            };
            output.answer(&document, || document.mermaid.trim_end().to_owned());
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// JSON document of `tabula task graph`: all tasks have one state machine.
#[derive(Debug, Serialize)]
struct GraphDocument {
    task: String,
    mermaid: String,
}

fn start(
    common: &CommonArguments,
    start: &StartArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let order = order(common, &start.task)?;
    let author = author_or_user(start.author.as_deref());
    let report = change(common, &request::order_task(mutation_id()?, author, order))?;
    if start.wait {
        return watch(common, report.task_id, output);
    }
    output.answer(&report, || {
        let number = report.task_id.unwrap_or_default();
        format!("task {number} has begun; follow it with: tabula task watch")
    });
    Ok(ExitCode::SUCCESS)
}

/// Order of a task, with its object looked up.
fn order(common: &CommonArguments, task: &TaskChoice) -> Result<TaskOrder, Failure> {
    match task {
        TaskChoice::ClearTable => Ok(TaskOrder::default()),
        TaskChoice::Fetch(FetchArguments {
            track,
            category,
            to,
        }) => {
            let track = track.as_ref();
            let track = track.map(|track| track.resolve(common, TrackScope::LOOK, None));
            Ok(TaskOrder {
                kind: TaskKind::Fetch,
                category: category.clone(),
                track_id: track.transpose()?,
                place: to.clone(),
            })
        }
    }
}

/// Sends a command to a task.
fn command(
    common: &CommonArguments,
    argument: &TaskArgument,
    request: fn(u64) -> TypedRequest<TaskReport>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let number = number(common, argument)?;
    let report = ask_once(common, &request(number))?;
    output.answer(&report, || line(&report));
    Ok(ExitCode::SUCCESS)
}

/// Number of the task that is meant.
fn number(common: &CommonArguments, argument: &TaskArgument) -> Result<u64, Failure> {
    if let Some(number) = argument.task_id {
        return Ok(number);
    }
    let report = ask_once(common, &request::task_state())?;
    report.task_id.ok_or_else(|| {
        let sentence = "no task has run since the start of the daemon; `tabula task list` shows \
                        earlier ones";
        Failure::new(exit_code::REFUSED, sentence)
    })
}

/// Follows a task to its end, one line for each change; the exit code is its outcome.
fn watch(
    common: &CommonArguments,
    number: Option<u64>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stop = StopSignal::install()?;
    let mut client = connect(common)?;
    let mut last = None;
    while !stop.is_raised() {
        let report = ask(&mut client, &request::task_state())?;
        let Some(known) = report.task_id else {
            output.answer(&report, || state_text(&report));
            return Ok(ExitCode::SUCCESS);
        };
        if number.is_some_and(|number| number != known) {
            let sentence = format!("another task runs: {known}; see `tabula task list`");
            return Err(Failure::new(exit_code::REFUSED, sentence));
        }
        if last.as_ref() != Some(&report) {
            output.answer(&report, || line(&report));
        }
        match report.phase.as_str() {
            "succeeded" => return Ok(ExitCode::SUCCESS),
            "failed" | "cancelled" => return Ok(ExitCode::from(exit_code::REFUSED)),
            _ => {}
        }
        last = Some(report);
        stop.sleep(WATCH_PERIOD);
    }
    Ok(ExitCode::SUCCESS)
}

/// Running or last task; that none has run.
fn state_text(report: &TaskReport) -> String {
    if report.task_id.is_none() {
        return "no task has run since the start of the daemon".to_owned();
    }
    line(report)
}

/// Report of a task on one line.
fn line(report: &TaskReport) -> String {
    let number = report.task_id.unwrap_or_default();
    let mut text = format!("task {number}, {}: {}", report.phase, report.sentence);
    if report.attempt > 1 {
        let _ = write!(text, " Attempt {}.", report.attempt);
    }
    if !report.waits_for.is_empty() {
        let _ = write!(text, " Waits for: {}.", report.waits_for);
    }
    text
}

fn preview_text(report: &TaskReport) -> String {
    let left = report.left.iter().map(|left| left.reason.clone());
    let mut lines = vec![report.sentence.clone()];
    if !report.planned.is_empty() {
        lines.extend(left);
    }
    lines.join("\n")
}
