//! Supervised child process with restarts and back-off.

use actor::{RestartDecision, RestartHistory, RestartPolicy};
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use service::{CommonArguments, Failure, exit_code};
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child as OsChild, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Maximum number of restarts within [`WINDOW`]. Chosen.
const MAX_RESTARTS: u32 = 30;
const WINDOW: Duration = Duration::from_secs(60);
const FIRST_BACKOFF: Duration = Duration::from_millis(50);
const LONGEST_BACKOFF: Duration = Duration::from_secs(1);

/// Child process that is restarted when it ends.
pub(crate) struct Child {
    process: ProcessKind,
    arguments: Vec<String>,
    state: ChildState,
    history: RestartHistory,
}

enum ChildState {
    Running(OsChild),
    Waiting { until: Instant },
}

impl Child {
    /// Starts a child process.
    pub(crate) fn start(process: ProcessKind, arguments: Vec<String>) -> Result<Self, Failure> {
        let policy = RestartPolicy::new(MAX_RESTARTS, WINDOW, FIRST_BACKOFF, LONGEST_BACKOFF)
            .map_err(Failure::general)?;
        let state = ChildState::Running(spawn(process, &arguments)?);
        Ok(Self {
            process,
            arguments,
            state,
            history: RestartHistory::new(policy),
        })
    }

    /// Kind of the child process.
    pub(crate) fn process(&self) -> ProcessKind {
        self.process
    }

    /// Process id; `None` while the restart is pending.
    pub(crate) fn pid(&self) -> Option<u32> {
        match &self.state {
            ChildState::Running(child) => Some(child.id()),
            ChildState::Waiting { .. } => None,
        }
    }

    /// Polls the process and restarts it after its end.
    ///
    /// # Errors
    /// When it cannot go on: wrong arguments, or too many restarts.
    pub(crate) fn supervise(&mut self, say: impl Fn(&str)) -> Result<(), Failure> {
        match &mut self.state {
            ChildState::Running(child) => match child.try_wait() {
                Ok(Some(status)) => self.ended(status, say),
                _ => Ok(()),
            },
            ChildState::Waiting { until } if *until <= Instant::now() => {
                self.state = ChildState::Running(spawn(self.process, &self.arguments)?);
                say(&format!("{} was started again", self.process.program()));
                Ok(())
            }
            ChildState::Waiting { .. } => Ok(()),
        }
    }

    fn ended(&mut self, status: ExitStatus, say: impl Fn(&str)) -> Result<(), Failure> {
        let program = self.process.program();
        if let Some(code @ (exit_code::USAGE | exit_code::ALREADY_RUNNING)) =
            status.code().and_then(|code| u8::try_from(code).ok())
        {
            return Err(Failure::new(
                code,
                format!("{program} cannot run, see its message above"),
            ));
        }
        match self.history.on_failure(Instant::now()) {
            RestartDecision::Restart { after } => {
                say(&format!(
                    "{program} has ended ({status}); starting it again in {after:?}"
                ));
                self.state = ChildState::Waiting {
                    until: Instant::now() + after,
                };
                Ok(())
            }
            RestartDecision::Escalate => Err(Failure::general(format!(
                "{program} has ended more than {MAX_RESTARTS} times within {} s ({status}); \
                     see its messages above, and try: tabula doctor",
                WINDOW.as_secs()
            ))),
        }
    }

    /// Sends SIGTERM to the child process.
    pub(crate) fn ask_to_stop(&self) {
        if let ChildState::Running(child) = &self.state
            && let Some(pid) = Pid::from_raw(child.id().cast_signed())
        {
            let _ = kill_process(pid, Signal::TERM);
        }
    }

    /// True if the child process has ended.
    pub(crate) fn has_ended(&mut self) -> bool {
        match &mut self.state {
            ChildState::Running(child) => !matches!(child.try_wait(), Ok(None)),
            ChildState::Waiting { .. } => true,
        }
    }

    /// Kills the process and waits for its end.
    pub(crate) fn kill(&mut self) {
        if let ChildState::Running(child) = &mut self.state {
            let _ = child.kill();
            let _ = child.wait();
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

fn spawn(process: ProcessKind, arguments: &[String]) -> Result<OsChild, Failure> {
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
