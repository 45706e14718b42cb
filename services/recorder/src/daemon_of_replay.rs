//! Daemon of a replay, in a domain and with an empty memory of its own; stopped on drop.

use channel::DomainName;
use rustix::process::{Pid, Signal, kill_process};
use service::Failure;
use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longest time of a stop; the daemon guarantees 5 s.
const STOP_LIMIT: Duration = Duration::from_secs(7);
const POLL_PERIOD: Duration = Duration::from_millis(20);
/// Number of log lines in a failure.
const N_LOG_LINES: usize = 8;

/// Running daemon of a replay.
#[derive(Debug)]
pub(crate) struct DaemonOfReplay {
    child: Child,
    folder: TempDir,
}

impl DaemonOfReplay {
    /// Name of the domain of this process's replay.
    ///
    /// # Errors
    /// When it is no name of a domain.
    pub(crate) fn domain() -> Result<DomainName, Failure> {
        let name = format!("rep-{}", std::process::id());
        name.parse::<DomainName>().map_err(Failure::general)
    }

    /// Starts `tabula run` with the arguments, and does not wait for it: the first scenes come
    /// before all processes have reported that they work.
    ///
    /// # Errors
    /// When the program cannot be started.
    pub(crate) fn start(
        domain: &DomainName,
        config: Option<&Path>,
        arguments: &[String],
    ) -> Result<Self, Failure> {
        let folder = TempDir::with_prefix("tabula-replay-").map_err(Failure::general)?;
        let log = File::create(folder.path().join("daemon.log")).map_err(Failure::general)?;
        let own = std::env::current_exe().map_err(Failure::general)?;
        let child = Command::new(own.with_file_name("tabula"))
            .args(["run", "--json"])
            .arg(format!("--domain={domain}"))
            .arg(format!("--home={}", folder.path().display()))
            .arg(format!("--follow-parent={}", std::process::id()))
            .args(config.map(|path| format!("--config={}", path.display())))
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log)
            // Ctrl-C reaches only this program, which then stops the daemon.
            .process_group(0)
            .spawn()
            .map_err(|error| Failure::general(format!("tabula could not be started: {error}")))?;
        Ok(Self { child, folder })
    }

    /// True if the daemon has ended by itself.
    pub(crate) fn has_ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Last lines of the daemon's log.
    pub(crate) fn log_end(&self) -> String {
        let log = std::fs::read_to_string(self.folder.path().join("daemon.log"));
        let log = log.unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        lines[lines.len().saturating_sub(N_LOG_LINES)..].join("\n")
    }
}

impl Drop for DaemonOfReplay {
    fn drop(&mut self) {
        if let Some(pid) = Pid::from_raw(self.child.id().cast_signed()) {
            let _ = kill_process(pid, Signal::TERM);
        }
        let deadline = Instant::now() + STOP_LIMIT;
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
