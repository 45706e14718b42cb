//! Daemon of a measurement: spawned on some cores, and waited for until it is ready.

use channel::DomainName;
use control_client::SpawnedDaemon;
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use service::{Failure, exit_code};
use std::io::{BufRead, BufReader};
use std::process::{ChildStdout, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use tempfile::TempDir;

/// Maximum start-up time of the daemon.
const START_TIMEOUT: Duration = Duration::from_secs(60);
/// Maximum time from a daemon's last error message to its exit.
const EXIT_TIMEOUT: Duration = Duration::from_secs(1);

/// Spawned daemon in a domain and a folder of its own; stopped on drop.
#[derive(Debug)]
pub(crate) struct MeasuredDaemon {
    spawned: SpawnedDaemon,
    domain: DomainName,
}

impl MeasuredDaemon {
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
        let mut spawned = SpawnedDaemon::start(&domain, folder, arguments, Stdio::piped())?;
        drop(affinity);
        let ready = spawned.take_stdout().map(wait_until_ready);
        let mut daemon = Self { spawned, domain };
        match ready {
            Some(Ok(())) => Ok(daemon),
            _ => Err(daemon.not_ready()),
        }
    }

    /// Domain of the daemon.
    pub(crate) fn domain(&self) -> &DomainName {
        &self.domain
    }

    /// Process id of its `tabula run`.
    pub(crate) fn process_id(&self) -> u32 {
        self.spawned.process_id()
    }

    /// Start-up failure with the end of the log, and with the daemon's exit code if it has ended.
    fn not_ready(&mut self) -> Failure {
        let end = self.spawned.log_end();
        // The daemon may still be about to exit after its last message.
        let status = self.spawned.wait_for(EXIT_TIMEOUT);
        let code = status.and_then(|status| u8::try_from(status.code()?).ok());
        Failure::new(
            code.unwrap_or(exit_code::FAILURE),
            format!("the daemon to be measured did not become ready; the end of its log:\n{end}"),
        )
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
