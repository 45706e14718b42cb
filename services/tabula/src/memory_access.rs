//! The memory, through the daemon or, when none runs, opened here.

use crate::objects::{call, connect, refused, unexpected};
use channel::control::SocketClient;
use command_line::Output;
use memory_requests::{MemoryDesk, MemoryDeskConfig};
use message::control::{Command, JobCommand, JobKind, JobOutcome, JobReport, Reply};
use service::{CommonArguments, Failure, exit_code, wall_clock_ns};
use std::path::PathBuf;
use std::time::Duration;
use store::{Limits, StoreConfig, StoreThread, WRITE_BUFFER_BYTES};
use tokio::runtime::Runtime;

/// How often a job is asked how far it is.
const ASK_AGAIN: Duration = Duration::from_millis(50);

/// Answers commands about the memory.
pub(crate) enum MemoryAccess {
    /// The daemon does.
    Daemon(SocketClient),
    /// The store is open in this process.
    Local(Box<LocalMemory>),
}

/// The store, opened here.
pub(crate) struct LocalMemory {
    desk: MemoryDesk,
    runtime: Runtime,
    /// Closes the store when it is dropped.
    _thread: StoreThread,
}

/// The folder of the memory, when there is one and no daemon has it.
pub(crate) fn local_folder(common: &CommonArguments) -> Result<PathBuf, Failure> {
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

/// A connection to the daemon; none when there is none.
pub(crate) fn daemon(common: &CommonArguments) -> Result<Option<SocketClient>, Failure> {
    match connect(common) {
        Ok(client) => Ok(Some(client)),
        Err(failure) if failure.code == exit_code::NO_DAEMON => Ok(None),
        Err(failure) => Err(failure),
    }
}

impl MemoryAccess {
    /// Asks the daemon, or opens the store when there is none.
    pub(crate) fn open(common: &CommonArguments, output: &Output) -> Result<Self, Failure> {
        if let Some(client) = daemon(common)? {
            return Ok(Self::Daemon(client));
        }
        let folder = local_folder(common)?;
        output.tell(&format!(
            "no daemon runs in the domain {}; opening {}",
            common.domain,
            folder.display()
        ));
        let failed = |error: store::Error| Failure::new(exit_code::FAILURE, error);
        let scratch = common.home().path().join("exchange");
        let (thread, store, report) = StoreThread::start(StoreConfig {
            folder,
            queue_capacity: 64,
            limits: Limits::default(),
            write_buffer_bytes: WRITE_BUFFER_BYTES,
            wall_clock: || wall_clock_ns().max(0) as u64,
            on_reopened: Box::new(|_| {}),
        })
        .map_err(failed)?;
        output.tell(&report.to_string());
        let (desk, _) = MemoryDesk::new(MemoryDeskConfig {
            store,
            scratch,
            descriptor_kind: pipeline::DESCRIPTOR_KIND,
        });
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        let runtime = runtime.map_err(|error| Failure::new(exit_code::FAILURE, error))?;
        Ok(Self::Local(Box::new(LocalMemory {
            desk,
            runtime,
            _thread: thread,
        })))
    }

    /// Asks, and turns a refusal into a failure.
    pub(crate) fn call(&mut self, command: Command) -> Result<Reply, Failure> {
        match self {
            Self::Daemon(client) => call(client, command),
            Self::Local(local) => match local.runtime.block_on(local.desk.answer(command)) {
                Some(answer) => answer.map_err(refused),
                None => Err(Failure::new(
                    exit_code::NO_DAEMON,
                    "only a daemon can answer this; start one with: tabula run",
                )),
            },
        }
    }

    /// Asks something about a job.
    pub(crate) fn job(&mut self, command: JobCommand) -> Result<JobReport, Failure> {
        match self.call(Command::Job(command))? {
            Reply::Job(report) => Ok(report),
            other => Err(unexpected(&other)),
        }
    }

    /// Begins a job.
    pub(crate) fn begin(&mut self, kind: JobKind) -> Result<JobReport, Failure> {
        self.job(JobCommand::Begin(kind))
    }

    /// Waits for what comes of a job; `tell` is told how far it is.
    pub(crate) fn wait(
        &mut self,
        job: u64,
        mut tell: impl FnMut(&JobReport),
    ) -> Result<JobOutcome, Failure> {
        loop {
            let report = self.job(JobCommand::Ask { job })?;
            tell(&report);
            match report.outcome {
                Some(JobOutcome::Failed(why)) => {
                    return Err(Failure::new(exit_code::FAILURE, why));
                }
                Some(outcome) => return Ok(outcome),
                None => std::thread::sleep(ASK_AGAIN),
            }
        }
    }
}
