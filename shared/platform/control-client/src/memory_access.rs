//! Access to the memory: through the daemon, or through a child process that opens it.

use crate::connection::{call, connect, unexpected};
use channel::control::SocketClient;
use command_line::Output;
use message::control::{Command, JobCommand, JobKind, JobOutcome, JobReport, Reply};
use service::{CommonArguments, Failure, exit_code};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Polling period of a job's progress.
const POLL_PERIOD: Duration = Duration::from_millis(50);
/// Limit of one answer without a daemon: opening may repair a large database first.
const OFFLINE_DEADLINE: Duration = Duration::from_secs(24 * 3600);

/// Connection on which requests about the memory are answered.
#[derive(Debug)]
pub struct MemoryAccess {
    client: SocketClient,
    /// Dropped after the connection, whose end makes the child close the store and exit.
    _offline: Option<OfflineMemory>,
}

/// A `tabula-memory --offline` of our own.
#[derive(Debug)]
struct OfflineMemory(Child);

impl Drop for OfflineMemory {
    fn drop(&mut self) {
        // It has been told by the closed socket; a failure was reported by itself.
        let _ = self.0.wait();
    }
}

/// Folder of the perceptual memory, if one exists there.
///
/// # Errors
/// When there is none, or this user may not read it.
pub fn local_folder(common: &CommonArguments) -> Result<PathBuf, Failure> {
    let folder = common.home().perceptual_memory();
    let Err(error) = std::fs::metadata(folder.join("database")) else {
        return Ok(folder);
    };
    let why = match error.kind() {
        std::io::ErrorKind::NotFound => "there is no memory there; name its folder by --home",
        std::io::ErrorKind::PermissionDenied => {
            "it belongs to another user; ask as that user, or let the daemon answer"
        }
        _ => "see that the disk is there",
    };
    let (domain, folder) = (&common.domain, folder.display());
    Err(Failure::new(
        exit_code::NO_DAEMON,
        format!(
            "no daemon runs in the domain {domain}, and {folder} cannot be opened ({error}): {why}"
        ),
    ))
}

/// Connection to the daemon, if one runs.
///
/// # Errors
/// When a daemon is there but does not let us in.
pub fn daemon(common: &CommonArguments) -> Result<Option<SocketClient>, Failure> {
    match connect(common) {
        Ok(client) => Ok(Some(client)),
        Err(failure) if failure.code == exit_code::NO_DAEMON => Ok(None),
        Err(failure) => Err(failure),
    }
}

impl From<SocketClient> for MemoryAccess {
    fn from(client: SocketClient) -> Self {
        Self {
            client,
            _offline: None,
        }
    }
}

impl MemoryAccess {
    /// Connects to the daemon, or starts `tabula-memory --offline` when none runs.
    ///
    /// # Errors
    /// When there is neither a daemon nor a memory, or the program cannot be started.
    pub fn open(common: &CommonArguments, output: &Output) -> Result<Self, Failure> {
        if let Some(client) = daemon(common)? {
            return Ok(client.into());
        }
        let folder = local_folder(common)?;
        output.print_status(&format!(
            "no daemon runs in the domain {}; opening {}",
            common.domain,
            folder.display()
        ));
        Self::offline(common)
    }

    /// Starts `tabula-memory --offline`, which opens the store when it is first asked
    /// something that needs it.
    ///
    /// # Errors
    /// When the program cannot be started.
    pub fn offline(common: &CommonArguments) -> Result<Self, Failure> {
        let not_there = |error: std::io::Error| {
            let sentence = format!(
                "tabula-memory could not be started: {error}; it belongs into the folder of this \
                 program"
            );
            Failure::new(exit_code::FAILURE, sentence)
        };
        let (ours, theirs) = UnixStream::pair().map_err(not_there)?;
        let own = std::env::current_exe().map_err(not_there)?;
        let child = std::process::Command::new(own.with_file_name("tabula-memory"))
            .arg("--offline")
            .env("TABULA_DOMAIN", common.domain.to_string())
            .env("TABULA_HOME", common.home().path())
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::null())
            .spawn()
            .map_err(not_there)?;
        let offline = OfflineMemory(child);
        let client = SocketClient::from_stream(ours, OFFLINE_DEADLINE)
            .map_err(|error| Failure::new(exit_code::FAILURE, error))?;
        Ok(Self {
            client,
            _offline: Some(offline),
        })
    }

    /// Sends a request; a refusal becomes a failure.
    ///
    /// # Errors
    /// When the request is refused, or the other side has gone.
    pub fn call(&mut self, command: Command) -> Result<Reply, Failure> {
        call(&mut self.client, command)
    }

    /// Sends a request about a job.
    ///
    /// # Errors
    /// As [`Self::call`].
    pub fn job(&mut self, command: JobCommand) -> Result<JobReport, Failure> {
        match self.call(Command::Job(command))? {
            Reply::Job(report) => Ok(report),
            other => Err(unexpected(&other)),
        }
    }

    /// Begins a job.
    ///
    /// # Errors
    /// As [`Self::call`].
    pub fn begin(&mut self, kind: JobKind) -> Result<JobReport, Failure> {
        self.job(JobCommand::Begin(kind))
    }

    /// Waits for the outcome of a job; `on_progress` gets each report.
    ///
    /// # Errors
    /// When the job fails, or the other side has gone.
    pub fn wait(
        &mut self,
        job: u64,
        mut on_progress: impl FnMut(&JobReport),
    ) -> Result<JobOutcome, Failure> {
        loop {
            let report = self.job(JobCommand::Ask { job })?;
            on_progress(&report);
            match report.outcome {
                Some(JobOutcome::Failed(why)) => {
                    return Err(Failure::new(exit_code::FAILURE, why));
                }
                Some(outcome) => return Ok(outcome),
                None => std::thread::sleep(POLL_PERIOD),
            }
        }
    }
}
