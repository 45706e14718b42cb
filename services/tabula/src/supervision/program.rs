//! Programs of the daemon: command lines, check of their arguments, start.

use message::ProcessKind;
use service::{CommonArguments, Failure, exit_code};
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child as OsChild, Command, Stdio};

/// Process of the daemon with its program and arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ProcessCommand {
    /// Kind of the process.
    pub(crate) process: ProcessKind,
    /// Program of the user; `None` for that of its kind beside this one.
    pub(crate) program: Option<PathBuf>,
    pub(crate) arguments: Vec<String>,
}

impl ProcessCommand {
    /// Process by the program beside this one.
    pub(crate) fn new(process: ProcessKind, arguments: Vec<String>) -> Self {
        Self {
            process,
            program: None,
            arguments,
        }
    }
}

/// Arguments common to all processes of one daemon.
pub(crate) fn common_arguments(common: &CommonArguments) -> Vec<String> {
    let mut arguments = vec![format!("--domain={}", common.domain)];
    arguments.push(format!("--home={}", common.home().path().display()));
    if let Some(config) = &common.config {
        arguments.push(format!("--config={}", config.display()));
    }
    arguments
}

/// Validates a process's arguments and its section of the configuration with `--check-config`.
///
/// # Errors
/// The sentence with which the process refuses them, and its exit code.
pub(crate) fn check(checked: &ProcessCommand) -> Result<(), Failure> {
    let process = checked.process;
    let output = command(checked)?
        .arg("--check-config")
        .stderr(Stdio::piped())
        .output();
    let output = output.map_err(|error| start_failure(process, &error))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let (log, refusal) = split_refusal(&text, &process.program());
    print_log(log);
    if output.status.success() {
        return Ok(());
    }
    let code = output
        .status
        .code()
        .and_then(|code| u8::try_from(code).ok());
    let sentence = refusal.map_or_else(
        || format!("{} cannot run, see its message above", process.program()),
        str::to_owned,
    );
    Err(Failure::new(code.unwrap_or(exit_code::FAILURE), sentence))
}

/// Splits the output of a check into log lines and the refusal behind the program's name, which
/// comes last.
fn split_refusal<'a>(output: &'a str, program: &str) -> (&'a str, Option<&'a str>) {
    let begins = |at: usize| at == 0 || output.as_bytes()[at - 1] == b'\n';
    let prefix = format!("{program}: ");
    let mut found = output.match_indices(&prefix);
    match found.find(|(at, _)| begins(*at)) {
        Some((at, _)) => (&output[..at], Some(output[at + prefix.len()..].trim_end())),
        None => (output, None),
    }
}

/// Passes log lines of a check on.
#[expect(clippy::print_stderr, reason = "a log of another process")]
fn print_log(log: &str) {
    if !log.is_empty() {
        eprint!("{log}");
    }
}

/// Starts a program as a child that follows this process.
pub(crate) fn spawn(started: &ProcessCommand) -> Result<OsChild, Failure> {
    let mut command = command(started)?;
    command.arg(format!("--follow-parent={}", std::process::id()));
    // A group of its own: Ctrl-C reaches the parent only, which stops all in order.
    command.process_group(0);
    command
        .spawn()
        .map_err(|error| start_failure(started.process, &error))
}

/// Command of the program with its arguments. Its output goes to the log.
fn command(called: &ProcessCommand) -> Result<Command, Failure> {
    let program = match &called.program {
        Some(program) => existing(program)?,
        None => own_program(called.process)?,
    };
    let mut command = Command::new(program);
    command.args(&called.arguments).stdin(Stdio::null());
    if let Ok(log) = std::io::stderr().as_fd().try_clone_to_owned() {
        command.stdout(log);
    }
    Ok(command)
}

/// Program of the user, by its path: it is not looked for in `PATH`.
fn existing(program: &Path) -> Result<PathBuf, Failure> {
    let found = program.canonicalize();
    found.map_err(|error| {
        let shown = program.display();
        Failure::usage(format!("{shown} cannot be started: {error}; give its path"))
    })
}

/// Program in the folder of this one.
fn own_program(process: ProcessKind) -> Result<PathBuf, Failure> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusal_is_behind_the_name_of_its_program() {
        let split = |output| split_refusal(output, "tabula-camera");
        assert_eq!(split(""), ("", None));
        assert_eq!(
            split("tabula-camera: the folder x is empty\n"),
            ("", Some("the folder x is empty"))
        );
        let log = "WARN about tabula-camera: odd\n";
        assert_eq!(split(log), (log, None));
        let both = format!("{log}tabula-camera: wrong\nand more\n");
        assert_eq!(split(&both), (log, Some("wrong\nand more")));
    }
}
