//! Programs of the daemon: command lines, check of their arguments, start.

use message::ProcessKind;
use service::{CommonArguments, Failure, exit_code};
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child as OsChild, Command, Stdio};

/// Arguments common to all processes of one daemon.
pub(crate) fn common_arguments(common: &CommonArguments) -> Vec<String> {
    let mut arguments = vec![format!("--domain={}", common.domain)];
    arguments.push(format!("--home={}", common.home().path().display()));
    if let Some(config) = &common.config {
        arguments.push(format!("--config={}", config.display()));
    }
    arguments
}

/// Validates a process's arguments with `--check-config`.
pub(crate) fn check(process: ProcessKind, arguments: &[String]) -> Result<(), Failure> {
    let status = command(process)?
        .args(arguments)
        .arg("--check-config")
        .status();
    match status.map_err(|error| start_failure(process, &error))? {
        status if status.success() => Ok(()),
        status => Err(Failure::new(
            status
                .code()
                .and_then(|code| u8::try_from(code).ok())
                .unwrap_or(exit_code::FAILURE),
            format!("{} cannot run, see its message above", process.program()),
        )),
    }
}

/// Starts a program as a child that follows this process.
pub(crate) fn spawn(process: ProcessKind, arguments: &[String]) -> Result<OsChild, Failure> {
    let mut command = command(process)?;
    let parent = format!("--follow-parent={}", std::process::id());
    command.args(arguments).arg(parent);
    // A group of its own: Ctrl-C reaches the parent only, which stops all in order.
    command.process_group(0);
    command
        .spawn()
        .map_err(|error| start_failure(process, &error))
}

/// Command of the program in the folder of this one. Its output goes to the log.
fn command(process: ProcessKind) -> Result<Command, Failure> {
    let mut command = Command::new(program(process)?);
    command.stdin(Stdio::null());
    if let Ok(log) = std::io::stderr().as_fd().try_clone_to_owned() {
        command.stdout(log);
    }
    Ok(command)
}

fn program(process: ProcessKind) -> Result<PathBuf, Failure> {
    let own = std::env::current_exe().map_err(|error| start_failure(process, &error))?;
    let program = own.with_file_name(process.program());
    if program.exists() {
        return Ok(program);
    }
    Err(Failure::general(format!(
        "{} is not there; build all programs with: cargo build --release --workspace --bins",
        program.display()
    )))
}

fn start_failure(process: ProcessKind, error: &std::io::Error) -> Failure {
    let sentence = format!("{} could not be started: {error}", process.program());
    Failure::general(sentence)
}
