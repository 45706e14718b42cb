//! Daemon spawned for a measurement and stopped on drop.

use channel::DomainName;
use rustix::process::{Pid, Signal, kill_process};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use service::{Failure, exit_code};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Maximum start-up time of the daemon.
const START_TIMEOUT: Duration = Duration::from_secs(60);
/// Maximum shutdown time; the daemon guarantees 5 s.
const STOP_TIMEOUT: Duration = Duration::from_secs(7);
/// Maximum time from a daemon's last error message to its exit.
const EXIT_TIMEOUT: Duration = Duration::from_secs(1);
const POLL_PERIOD: Duration = Duration::from_millis(20);
/// Number of log lines shown in a failure.
const N_LOG_LINES: usize = 8;

/// Spawned daemon in a domain and a folder of its own; stopped on drop.
#[derive(Debug)]
pub(crate) struct SpawnedDaemon {
    child: Child,
    domain: DomainName,
    folder: TempDir,
}

impl SpawnedDaemon {
    /// Creates a temporary home folder for a daemon.
    ///
    /// # Errors
    /// If it cannot be created.
    pub(crate) fn home() -> Result<TempDir, Failure> {
        TempDir::with_prefix("tabula-latency-").map_err(|error| {
            Failure::general(format!("no folder for the daemon could be made: {error}"))
        })
    }

    /// Spawns `tabula run` with the given arguments in a home folder, on the first `n_cores`
    /// cores or on all, and waits until it is ready.
    ///
    /// # Errors
    /// If it cannot be spawned or does not become ready; with the end of its log.
    pub(crate) fn start(
        folder: TempDir,
        arguments: &[String],
        n_cores: Option<usize>,
    ) -> Result<Self, Failure> {
        // Short, because it is part of a socket's path.
        let name = format!("lat-{}", std::process::id());
        let domain = name.parse::<DomainName>().map_err(Failure::general)?;
        let affinity = n_cores.map(AffinityGuard::first).transpose()?;
        let mut child = spawn(&domain, folder.path(), arguments)?;
        drop(affinity);
        let ready = child.stdout.take().map(wait_until_ready);
        let mut daemon = Self {
            child,
            domain,
            folder,
        };
        match ready {
            Some(Ok(())) => Ok(daemon),
            _ => Err(daemon.not_ready()),
        }
    }

    /// Domain of the daemon.
    pub(crate) fn domain(&self) -> &DomainName {
        &self.domain
    }

    /// Start-up failure with the end of the log, and with the daemon's exit code if it has ended.
    fn not_ready(&mut self) -> Failure {
        let log = std::fs::read_to_string(log_file(self.folder.path())).unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        let end = lines[lines.len().saturating_sub(N_LOG_LINES)..].join("\n");
        // The daemon may still be about to exit after its last message.
        let deadline = Instant::now() + EXIT_TIMEOUT;
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < deadline {
            std::thread::sleep(POLL_PERIOD);
        }
        let code = match self.child.try_wait() {
            Ok(Some(status)) => status.code().and_then(|code| u8::try_from(code).ok()),
            _ => None,
        };
        Failure::new(
            code.unwrap_or(exit_code::FAILURE),
            format!("the daemon to be measured did not become ready; the end of its log:\n{end}"),
        )
    }
}

impl Drop for SpawnedDaemon {
    fn drop(&mut self) {
        if let Some(pid) = Pid::from_raw(self.child.id().cast_signed()) {
            let _ = kill_process(pid, Signal::TERM);
        }
        let deadline = Instant::now() + STOP_TIMEOUT;
        while matches!(self.child.try_wait(), Ok(None)) {
            if Instant::now() > deadline {
                let _ = self.child.kill();
                let _ = self.child.wait();
                return;
            }
            std::thread::sleep(POLL_PERIOD);
        }
    }
}

/// Restricts the affinity of this thread, and so of the processes it spawns, to the first cores;
/// drop restores it.
struct AffinityGuard {
    before: CpuSet,
}

impl AffinityGuard {
    fn first(n_cores: usize) -> Result<Self, Failure> {
        let before = sched_getaffinity(None).map_err(Failure::general)?;
        let allowed = (0..CpuSet::MAX_CPU).filter(|core| before.is_set(*core));
        let mut chosen = CpuSet::new();
        allowed.take(n_cores).for_each(|core| chosen.set(core));
        sched_setaffinity(None, &chosen).map_err(Failure::general)?;
        Ok(Self { before })
    }
}

impl Drop for AffinityGuard {
    fn drop(&mut self) {
        let _ = sched_setaffinity(None, &self.before);
    }
}

fn log_file(folder: &Path) -> std::path::PathBuf {
    folder.join("daemon.log")
}

fn spawn(domain: &DomainName, folder: &Path, arguments: &[String]) -> Result<Child, Failure> {
    let program = std::env::current_exe()
        .map(|own| own.with_file_name("tabula"))
        .map_err(Failure::general)?;
    let log = File::create(log_file(folder)).map_err(Failure::general)?;
    Command::new(&program)
        .args(["run", "--json"])
        .arg(format!("--domain={domain}"))
        .arg(format!("--home={}", folder.display()))
        .arg(format!("--follow-parent={}", std::process::id()))
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(log)
        // Ctrl-C reaches only the measuring program, which then stops the daemon.
        .process_group(0)
        .spawn()
        .map_err(|error| {
            Failure::general(format!(
                "{} could not be started: {error}; build all programs with: \
                 cargo build --release --workspace --bins",
                program.display()
            ))
        })
}

/// `true` if a line is the document of a daemon whose processes all work.
fn is_ready(line: &str) -> bool {
    let document: Result<serde_json::Value, _> = serde_json::from_str(line);
    document.is_ok_and(|document| document["processes"].is_array())
}

/// Waits for the daemon's start-up document, printed when all processes work.
fn wait_until_ready(stdout: ChildStdout) -> Result<(), RecvTimeoutError> {
    let (sender, ready) = channel();
    std::thread::spawn(move || {
        for line in BufReader::new(stdout).lines().map_while(Result::ok) {
            if is_ready(&line) && sender.send(()).is_err() {
                return;
            }
        }
    });
    ready.recv_timeout(START_TIMEOUT)
}
