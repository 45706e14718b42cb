//! `tabula replay`: a daemon whose camera is a recording.

use crate::arguments::ReplayArguments;
use crate::replay_events;
use command_line::Output;
use service::{CommonArguments, Failure};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Replays a recording: becomes `tabula run` with it, or writes its events and ends.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &ReplayArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    check_name(&arguments.file)?;
    match &arguments.events {
        Some(out) => replay_events::run(common, arguments, out, output),
        None => Err(become_daemon(common, arguments, output)),
    }
}

/// Refuses a name that `tabula run` would take for another kind of source.
fn check_name(file: &Path) -> Result<(), Failure> {
    let name = file.to_string_lossy();
    if recording::is_recording_name(&name) && file.is_file() {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "{name} is no recording; name a file that ends with .mcap or .mcap.active"
    )))
}

/// Replaces this process by `tabula run`; returns only on failure.
fn become_daemon(
    common: &CommonArguments,
    arguments: &ReplayArguments,
    output: &Output,
) -> Failure {
    let own = match std::env::current_exe() {
        Ok(own) => own,
        Err(error) => return Failure::general(format!("tabula could not be started: {error}")),
    };
    let error = Command::new(own.with_file_name("tabula"))
        .arg("run")
        .arg(format!("--domain={}", common.domain))
        .arg(format!("--home={}", common.home().path().display()))
        .args(
            common
                .config
                .iter()
                .map(|path| format!("--config={}", path.display())),
        )
        .args(output.is_json().then_some("--json"))
        .args(arguments.run_arguments())
        .exec();
    Failure::general(format!("tabula could not be started: {error}"))
}
