//! `tabula run`: supervisor that runs the daemon's processes as children.

use crate::arguments::RunArguments;
use crate::daemon_reload::DaemonReload;
use crate::sensor::Sensor;
use crate::supervision::{self, Child, ProcessCommand, Supervision, SupervisionConfig};
use channel::{Domain, Role, RunFolder};
use command_line::{Output, StopSignal};
use control_protocol::request;
use daemon_client::DaemonClient;
use message::{Duty, ProcessKind};
use serde::Serialize;
use service::{CommonArguments, Configuration, Failure, guest_places, start_log, stop_with_parent};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Name of the exclusive role of `tabula run` in its domain.
const ROLE: &str = "tabula-run";

/// Polling period of the children. Chosen.
const POLL_PERIOD: Duration = Duration::from_millis(20);
/// Period of the readiness check. Chosen.
const READINESS_PERIOD: Duration = Duration::from_millis(200);
/// Time limit of an answer to the readiness check; the children are not polled meanwhile.
const READINESS_TIMEOUT: Duration = Duration::from_millis(500);

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
    start_log();
    let home = common.home();
    let found = Configuration::find(common.config.as_deref(), home.path())?;
    let config = SupervisionConfig::new(&found)?;
    let processes = checked_processes(common, run)?;
    if run.check_config {
        output.print_text("the configuration and the arguments are in order");
        return Ok(ExitCode::SUCCESS);
    }
    let (stop, hang_ups) = StopSignal::install_beside_hang_ups()?;
    if run
        .follow_parent
        .is_some_and(|parent| !stop_with_parent(parent))
    {
        return Ok(ExitCode::SUCCESS);
    }
    // A member of the domain until all children have ended: the last member removes its files,
    // even those of killed processes.
    let domain = Domain::join_with(
        &common.domain,
        &RunFolder::of_user(),
        Role::Only(ROLE),
        guest_places(&found)?,
    )?;
    let mut supervision = Supervision::new(&domain, config)?;
    let mut reload = DaemonReload::new(&domain, hang_ups, found, (common, run))?;
    let outcome = processes
        .into_iter()
        .try_for_each(|command| supervision.start(command))
        .and_then(|()| keep_running(&mut supervision, &mut reload, common, &stop, output));
    tracing::info!("stopping all processes");
    supervision.stop();
    outcome.map(|()| ExitCode::SUCCESS)
}

/// Processes of the daemon with their arguments, which they have checked themselves, with all of the
/// configuration.
///
/// # Errors
/// The sentence of the process that refuses its arguments or its section.
pub(crate) fn checked_processes(
    common: &CommonArguments,
    run: &RunArguments,
) -> Result<Vec<ProcessCommand>, Failure> {
    let sensor = Sensor::choose(common, run.source())?;
    let for_sensor = run.for_sensor(&sensor)?;
    let command = |process: ProcessKind| {
        let mut command = ProcessCommand::new(process, supervision::common_arguments(common));
        if process == sensor.process() {
            command.arguments.extend_from_slice(&for_sensor);
        }
        if process.has(Duty::Driver) {
            command.program.clone_from(&run.arm_driver);
        }
        command
    };
    let processes = sensor.processes(run.arm_driver.is_some());
    let processes: Vec<_> = processes.into_iter().map(command).collect();
    processes.iter().try_for_each(supervision::check)?;
    let (idle, idle_arguments) = sensor.idle();
    let mut idle = command(idle);
    let words = idle_arguments.iter().map(|&word| word.to_owned());
    idle.arguments.extend(words);
    supervision::check(&idle)?;
    Ok(processes)
}

fn keep_running(
    supervision: &mut Supervision,
    reload: &mut DaemonReload,
    common: &CommonArguments,
    stop: &StopSignal,
    output: &Output,
) -> Result<(), Failure> {
    let domain = reload.domain().clone();
    let mut is_announced = false;
    let mut next_readiness_check = Instant::now();
    while !stop.is_raised() {
        supervision.poll()?;
        if reload.is_terminal_closed() {
            tracing::info!("stopping: the terminal was closed");
            return Ok(());
        }
        reload.poll(supervision);
        if !is_announced && next_readiness_check <= Instant::now() {
            is_announced = is_ready(supervision.children(), &domain);
            next_readiness_check = Instant::now() + READINESS_PERIOD;
            if is_announced {
                announce(supervision.children(), common, &domain, output);
            }
        }
        stop.sleep(POLL_PERIOD);
    }
    Ok(())
}

/// True if every child reports that it works. Process ids are compared, since another daemon in the
/// domain might answer.
fn is_ready(children: &[Child], domain: &Domain) -> bool {
    let folders = [RunFolder::of_user()];
    let asked = request::health();
    let health = DaemonClient::ask_once(domain.name(), &folders, READINESS_TIMEOUT, &asked);
    let Ok(processes) = health else {
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
                process: child.process().word(),
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
