//! Client of the perceptual memory: connected to the daemon, or to a child process that opens
//! the store.

use crate::change::{PATIENCE, until_known};
use crate::connection::{ask, connect, try_connect};
use control_protocol::{JobOutcome, JobReport, TypedRequest, request};
use daemon_client::DaemonClient;
use service::{CommonArguments, Failure, exit_code};
use std::io::ErrorKind;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::Duration;
use unicode_text::escape_unprintable_lines;

/// Polling period of a job's progress. Chosen.
const POLL_PERIOD: Duration = Duration::from_millis(50);
/// Timeout of one answer without a daemon: opening may repair a large database first. Chosen.
const OFFLINE_DEADLINE: Duration = Duration::from_secs(24 * 3600);

/// Client connection to the perceptual memory.
#[derive(Debug)]
pub struct MemoryClient {
    pub(crate) client: DaemonClient,
    /// Arguments to connect to the daemon again; `None` without a daemon.
    pub(crate) daemon: Option<CommonArguments>,
    /// Child process, if any. Dropped after the connection, whose end makes the child close the
    /// store and exit.
    _offline: Option<OfflineProcess>,
}

/// Child process `tabula-memory --offline`.
#[derive(Debug)]
struct OfflineProcess(Child);

impl Drop for OfflineProcess {
    fn drop(&mut self) {
        // The closed socket ends the child, which reports its own failures.
        let _ = self.0.wait();
    }
}

/// Folder of the perceptual memory of this computer.
///
/// # Errors
/// If the memory does not exist or this user may not read it.
pub fn local_memory_folder(common: &CommonArguments) -> Result<PathBuf, Failure> {
    let folder = common.home().perceptual_memory();
    match std::fs::metadata(folder.join("database")) {
        Ok(_) => Ok(folder),
        Err(error) => Err(not_there(common, &folder, &error)),
    }
}

fn not_there(common: &CommonArguments, folder: &Path, error: &std::io::Error) -> Failure {
    let reason = match error.kind() {
        ErrorKind::NotFound => "there is no memory there; name its folder by --home",
        ErrorKind::PermissionDenied => {
            "it belongs to another user; ask as that user, or let the daemon answer"
        }
        _ => "see that the disk is there",
    };
    let (domain, folder) = (&common.domain, folder.display());
    Failure::new(
        exit_code::NO_DAEMON,
        format!(
            "no daemon runs in the domain {domain}, and {folder} cannot be opened ({error}): {reason}"
        ),
    )
}

/// Failure of a job that ended as another kind of job does: client and memory differ.
pub fn unexpected_outcome(outcome: &JobOutcome) -> Failure {
    let sentence = "use the tabula of the daemon's version";
    Failure::general(format!(
        "the job ended as another one: {outcome:?}; {sentence}"
    ))
}

/// Prints a remark beside the output of the command, which may be the bytes of a document.
#[expect(clippy::print_stderr, reason = "standard output is the command's own")]
pub(crate) fn print_aside(text: &str) {
    eprintln!("tabula: {}", escape_unprintable_lines(text));
}

/// Connection to the daemon; `None` if no daemon runs.
///
/// # Errors
/// If a daemon runs but refuses the connection.
pub fn connect_if_running(common: &CommonArguments) -> Result<Option<DaemonClient>, Failure> {
    match connect(common) {
        Ok(client) => Ok(Some(client)),
        Err(failure) if failure.code == exit_code::NO_DAEMON => Ok(None),
        Err(failure) => Err(failure),
    }
}

impl MemoryClient {
    /// Client of a daemon over an open connection to it.
    pub fn of_daemon(common: &CommonArguments, client: DaemonClient) -> Self {
        Self {
            client,
            daemon: Some(common.clone()),
            _offline: None,
        }
    }

    /// Connects to the daemon, or starts `tabula-memory --offline` if no daemon runs.
    ///
    /// # Errors
    /// If there is neither a daemon nor a memory, or the program cannot be started.
    pub fn open(common: &CommonArguments) -> Result<Self, Failure> {
        if let Some(client) = connect_if_running(common)? {
            return Ok(Self::of_daemon(common, client));
        }
        let folder = local_memory_folder(common)?;
        Self::open_telling(common, "opening", &folder)
    }

    /// As [`open`](Self::open), but where there is no memory a new one is made.
    ///
    /// # Errors
    /// If there is a memory that this user may not read, or the program cannot be started.
    pub fn open_or_create(common: &CommonArguments) -> Result<Self, Failure> {
        if let Some(client) = connect_if_running(common)? {
            return Ok(Self::of_daemon(common, client));
        }
        let folder = common.home().perceptual_memory();
        match std::fs::metadata(folder.join("database")) {
            Ok(_) => Self::open_telling(common, "opening", &folder),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Self::open_telling(common, "making a new memory in", &folder)
            }
            Err(error) => Err(not_there(common, &folder, &error)),
        }
    }

    fn open_telling(common: &CommonArguments, doing: &str, folder: &Path) -> Result<Self, Failure> {
        print_aside(&format!(
            "no daemon runs in the domain {}; {doing} {}",
            common.domain,
            folder.display()
        ));
        Self::open_offline(common)
    }

    /// Starts `tabula-memory --offline`, which opens the store at the first request that needs
    /// it.
    ///
    /// # Errors
    /// If the program cannot be started.
    pub fn open_offline(common: &CommonArguments) -> Result<Self, Failure> {
        let not_started = |error: std::io::Error| {
            let sentence = format!(
                "tabula-memory could not be started: {error}; it belongs into the folder of this \
                 program"
            );
            Failure::general(sentence)
        };
        let (socket, child_socket) = UnixStream::pair().map_err(not_started)?;
        let own = std::env::current_exe().map_err(not_started)?;
        let child = std::process::Command::new(own.with_file_name("tabula-memory"))
            .arg("--offline")
            .env("TABULA_DOMAIN", common.domain.to_string())
            .env("TABULA_HOME", common.home().path())
            .stdin(Stdio::from(OwnedFd::from(child_socket)))
            .stdout(Stdio::null())
            .spawn()
            .map_err(not_started)?;
        let offline = OfflineProcess(child);
        let client =
            DaemonClient::from_stream(socket, OFFLINE_DEADLINE).map_err(Failure::general)?;
        Ok(Self {
            client,
            daemon: None,
            _offline: Some(offline),
        })
    }

    /// Sends a request and returns the value of its reply; a refusal becomes a failure.
    ///
    /// # Errors
    /// If the request is refused or the connection ends.
    pub fn ask<T>(&mut self, request: &TypedRequest<T>) -> Result<T, Failure> {
        ask(&mut self.client, request)
    }

    /// Sends a change, again and again until its outcome is known, as
    /// [`change`](crate::change) does.
    ///
    /// # Errors
    /// As [`change`](crate::change).
    pub fn change<T>(&mut self, request: &TypedRequest<T>) -> Result<T, Failure> {
        let mut is_repeated = false;
        until_known(PATIENCE, || {
            if std::mem::replace(&mut is_repeated, true)
                && let Some(common) = &self.daemon
            {
                self.client = try_connect(common)?;
            }
            self.client.ask(request)
        })
    }

    /// Waits for the outcome of a job, which may be [`JobOutcome::Failed`].
    ///
    /// # Errors
    /// If the connection ends.
    pub fn job_outcome(
        &mut self,
        job: u64,
        mut on_progress: impl FnMut(&JobReport),
    ) -> Result<JobOutcome, Failure> {
        loop {
            let report = self.ask(&request::job(job))?;
            on_progress(&report);
            if let Some(outcome) = report.outcome {
                return Ok(outcome);
            }
            std::thread::sleep(POLL_PERIOD);
        }
    }
}
