//! Daemon that a program starts for itself, in a folder of its own; stopped on drop.

use channel::DomainName;
use rustix::process::{Pid, Signal, kill_process};
use service::Failure;
use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longest time of a stop; the daemon guarantees 5 s.
const STOP_TIMEOUT: Duration = Duration::from_secs(7);
const POLL_PERIOD: Duration = Duration::from_millis(20);
/// Number of log lines in a failure.
const N_LOG_LINES: usize = 8;

/// Running `tabula run` of this program, with its home folder; stopped on drop.
#[derive(Debug)]
pub struct SpawnedDaemon {
    child: Child,
    folder: TempDir,
}

impl SpawnedDaemon {
    /// Starts `tabula run` in a domain and a home folder, and does not wait for it.
    ///
    /// # Errors
    /// When the program cannot be started.
    pub fn start(
        domain: &DomainName,
        folder: TempDir,
        arguments: &[String],
        stdout: Stdio,
    ) -> Result<Self, Failure> {
        let program = std::env::current_exe()
            .map(|own| own.with_file_name("tabula"))
            .map_err(Failure::general)?;
        let log = File::create(folder.path().join("daemon.log")).map_err(Failure::general)?;
        let child = Command::new(&program)
            .args(["run", "--json"])
            .arg(format!("--domain={domain}"))
            .arg(format!("--home={}", folder.path().display()))
            .arg(format!("--follow-parent={}", std::process::id()))
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(stdout)
            .stderr(log)
            // Ctrl-C reaches only this program, which then stops the daemon.
            .process_group(0)
            .spawn()
            .map_err(|error| not_started(&program, &error))?;
        Ok(Self { child, folder })
    }

    /// Process id of `tabula run`.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    /// Standard output of the daemon, once, when it was started with a pipe.
    pub fn take_stdout(&mut self) -> Option<ChildStdout> {
        self.child.stdout.take()
    }

    /// Exit status of a daemon that has ended by itself; `None` while it runs.
    ///
    /// # Errors
    /// When the system does not tell.
    pub fn exit_status(&mut self) -> std::io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }

    /// Exit status of a daemon that ends within a time; `None` when it does not.
    pub fn wait_for(&mut self, timeout: Duration) -> Option<ExitStatus> {
        let deadline = Instant::now() + timeout;
        loop {
            match self.exit_status() {
                Ok(None) if Instant::now() < deadline => std::thread::sleep(POLL_PERIOD),
                status => return status.ok().flatten(),
            }
        }
    }

    /// Last lines of the daemon's log.
    pub fn log_end(&self) -> String {
        let log = std::fs::read_to_string(self.folder.path().join("daemon.log"));
        let log = log.unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        lines[lines.len().saturating_sub(N_LOG_LINES)..].join("\n")
    }
}

impl Drop for SpawnedDaemon {
    fn drop(&mut self) {
        if let Some(pid) = Pid::from_raw(self.child.id().cast_signed()) {
            let _ = kill_process(pid, Signal::TERM);
        }
        if self.wait_for(STOP_TIMEOUT).is_none() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

fn not_started(program: &Path, error: &std::io::Error) -> Failure {
    Failure::general(format!(
        "{} could not be started: {error}; build all programs with: \
         cargo build --release --workspace --bins",
        program.display()
    ))
}
