//! `tabula run`: supervisor that runs the daemon's processes as children.

use crate::arguments::RunArguments;
use crate::child::{self, Child};
use crate::sensor::Sensor;
use channel::{Domain, Role, RunFolder};
use command_line::{Output, StopSignal};
use control_client::{call, connect};
use message::ProcessKind;
use message::control::{Command, Reply};
use serde::Serialize;
use service::{CommonArguments, Failure, stop_with_parent};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Polling period of the children. Chosen.
const POLL_PERIOD: Duration = Duration::from_millis(20);
/// Period of the readiness check. Chosen.
const READINESS_PERIOD: Duration = Duration::from_millis(200);
/// Time that the children get to stop; the rest of the promised 5 s is for killing them.
const STOP_TIMEOUT: Duration = Duration::from_secs(4);

/// JSON announcement of the started daemon processes.
#[derive(Serialize)]
struct StartedDocument {
    domain: String,
    home: String,
    run_folder: String,
    processes: Vec<StartedProcess>,
}

#[derive(Serialize)]
struct StartedProcess {
    process: &'static str,
    pid: Option<u32>,
}

/// Runs the daemon until it is stopped or cannot go on.
pub(crate) fn run(
    common: &CommonArguments,
    run: &RunArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let sensor = Sensor::choose(common, run.source())?;
    let for_sensor = run.for_sensor(&sensor)?;
    let arguments = |process| {
        let mut all = child::common_arguments(common);
        if process == sensor.process() {
            all.extend_from_slice(&for_sensor);
        }
        all
    };
    let processes = sensor.processes();
    for &process in &processes {
        child::check(process, &arguments(process))?;
    }
    let (idle, idle_arguments) = sensor.idle();
    let idle_arguments = idle_arguments.iter().map(|&word| word.to_owned());
    let arguments_of_idle: Vec<String> =
        arguments(idle).into_iter().chain(idle_arguments).collect();
    child::check(idle, &arguments_of_idle)?;
    if run.check_config {
        output.print_text("the configuration and the arguments are in order");
        return Ok(ExitCode::SUCCESS);
    }
    let stop = StopSignal::install()?;
    if run
        .follow_parent
        .is_some_and(|parent| !stop_with_parent(parent))
    {
        return Ok(ExitCode::SUCCESS);
    }
    // A member of the domain until all children have ended: the last member removes its files,
    // even those of killed processes.
    let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
    let mut children = Vec::new();
    let outcome = start_all(&mut children, &processes, arguments)
        .and_then(|()| keep_running(&mut children, common, &domain, &stop, output));
    output.print_text("stopping");
    stop_all(&mut children);
    outcome.map(|()| ExitCode::SUCCESS)
}

fn start_all(
    children: &mut Vec<Child>,
    processes: &[ProcessKind],
    arguments: impl Fn(ProcessKind) -> Vec<String>,
) -> Result<(), Failure> {
    for &process in processes {
        children.push(Child::start(process, arguments(process))?);
    }
    Ok(())
}

fn keep_running(
    children: &mut [Child],
    common: &CommonArguments,
    domain: &Domain,
    stop: &StopSignal,
    output: &Output,
) -> Result<(), Failure> {
    let mut is_announced = false;
    let mut next_readiness_check = Instant::now();
    while !stop.is_raised() {
        for child in &mut *children {
            child.supervise(|text| output.print_status(text))?;
        }
        if !is_announced && next_readiness_check <= Instant::now() {
            is_announced = is_ready(children, common);
            next_readiness_check = Instant::now() + READINESS_PERIOD;
            if is_announced {
                announce(children, common, domain, output);
            }
        }
        stop.sleep(POLL_PERIOD);
    }
    Ok(())
}

/// True if every child reports that it works. Process ids are compared, since another daemon in the
/// domain might answer.
fn is_ready(children: &[Child], common: &CommonArguments) -> bool {
    let health = connect(common).and_then(|mut client| call(&mut client, Command::Health));
    let Ok(Reply::Health(processes)) = health else {
        return false;
    };
    let works = |child: &Child| {
        processes.iter().any(|report| {
            child.pid() == Some(report.pid) && !["starting", "stopping"].contains(&&*report.state)
        })
    };
    children.iter().all(works)
}

fn announce(children: &[Child], common: &CommonArguments, domain: &Domain, output: &Output) {
    let home = common.home();
    let document = StartedDocument {
        domain: domain.name().to_string(),
        home: home.path().display().to_string(),
        run_folder: domain.folder().display().to_string(),
        processes: children
            .iter()
            .map(|child| StartedProcess {
                process: child.process().name(),
                pid: child.pid(),
            })
            .collect(),
    };
    output.answer(&document, || announcement(&document));
}

fn announcement(document: &StartedDocument) -> String {
    let StartedDocument {
        domain,
        home,
        run_folder,
        processes,
    } = document;
    let started: Vec<String> = processes
        .iter()
        .map(|StartedProcess { process, pid }| {
            format!(
                "tabula-{process} ({})",
                pid.map_or("-".into(), |pid| pid.to_string())
            )
        })
        .collect();
    let option = if domain == "default" {
        String::new()
    } else {
        format!(" --domain {domain}")
    };
    format!(
        "tabula is running: {started}\n\
         domain {domain}, data in {home}, run folder {run_folder}\n\
         In a second terminal try:\n\
         \x20 tabula{option} objects --watch     see the tracked objects live\n\
         \x20 tabula{option} teach 3 mug         teach the name of track 3\n\
         \x20 tabula{option} ask 3               ask what track 3 is\n\
         \x20 tabula{option} doctor              check this machine\n\
         Ctrl-C stops everything.",
        started = started.join(", ")
    )
}

/// Stops the sensor process first, then the consumers of its frames.
fn stop_all(children: &mut [Child]) {
    for child in children.iter().rev() {
        child.ask_to_stop();
    }
    let deadline = Instant::now() + STOP_TIMEOUT;
    while Instant::now() < deadline && !children.iter_mut().all(Child::has_ended) {
        std::thread::sleep(POLL_PERIOD);
    }
    children.iter_mut().for_each(Child::kill);
}
