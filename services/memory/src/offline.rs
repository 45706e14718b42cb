//! Offline mode: the control protocol on standard input, without a daemon.
//!
//! `tabula memory`, `tabula knowledge` and `tabula model` start this when no daemon
//! runs, so that no client links the database. Standard input is one end of a socket
//! pair; its other end closes when the client is done.
#![expect(
    clippy::print_stderr,
    reason = "without a log, a person reads what was found when the store was opened"
)]

use crate::request_router::requester;
use channel::control::{handler, serve_process};
use channel::{DomainName, DomainState, RunFolder};
use control_protocol::{
    Command, JobCommand, JobKind, JobOutcome, JobReport, Peer, Refusal, RefusalKind, Reply,
};
use memory_requests::{
    MemoryRequestHandler, MemoryRequestHandlerConfig, UploadLimits, verification_report,
};
use perceptual_memory::{
    HistoryLimits, RetentionLimits, StoreConfig, StoreThread, WRITE_BUFFER_BYTES,
};
use service::{CommonArguments, Failure, wall_clock_ns};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A client may think as long as a person does; its end closes the connection.
const IDLE_LIMIT: Duration = Duration::from_secs(7 * 24 * 3600);
/// Capacity of the queue of requests that wait for the store.
const QUEUE_REQUESTS: usize = 64;
/// Limits of uploads: the disk is this user's own.
const UPLOADS: UploadLimits = UploadLimits {
    max_bytes: u64::MAX,
    free_disk_min_bytes: 0,
};
/// Number of the verification job; jobs of the opened store count from 1 too, but a
/// client that verifies asks for nothing else.
const VERIFICATION: u64 = u64::MAX;

/// Serves the client on standard input until it closes the connection.
///
/// # Errors
/// When standard input is no socket.
pub(crate) fn run(common: &CommonArguments) -> Result<(), Failure> {
    let failed = |error: std::io::Error| {
        let sentence = format!(
            "--offline serves a client on standard input, which must be a socket ({error}); use \
             `tabula memory` instead"
        );
        Failure::usage(sentence)
    };
    let stream = UnixStream::from(
        std::io::stdin()
            .as_fd()
            .try_clone_to_owned()
            .map_err(failed)?,
    );
    stream.set_nonblocking(true).map_err(failed)?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(failed)?;
    let offline = Arc::new(tokio::sync::Mutex::new(OfflineMemory::new(common)));
    let handler = handler(move |command, peer| {
        let offline = offline.clone();
        async move {
            let answer = offline.lock().await.answer(command, peer).await;
            answer.unwrap_or_else(Reply::Refused)
        }
    });
    runtime
        .block_on(async {
            let stream = tokio::net::UnixStream::from_std(stream)?;
            serve_process(stream, &handler, IDLE_LIMIT).await
        })
        .map_err(failed)
}

/// The stored memory of a home folder, opened when a request needs it.
struct OfflineMemory {
    common: CommonArguments,
    verification: Option<Arc<Verification>>,
    opened: Option<(MemoryRequestHandler, StoreThread)>,
}

impl OfflineMemory {
    fn new(common: &CommonArguments) -> Self {
        Self {
            common: common.clone(),
            verification: None,
            opened: None,
        }
    }

    async fn answer(&mut self, command: Command, peer: Peer) -> Result<Reply, Refusal> {
        refuse_beside_daemon(&self.common.domain)?;
        match command {
            // A copy is read; nothing is opened, repaired or changed.
            Command::Job(JobCommand::Begin(JobKind::Verify)) => {
                let folder = self.common.home().perceptual_memory();
                let verification = self.verification.insert(Verification::start(folder));
                Ok(Reply::Job(verification.report()))
            }
            Command::Job(JobCommand::Ask { job: VERIFICATION }) => match &self.verification {
                Some(verification) => Ok(Reply::Job(verification.report())),
                None => Err(Refusal::new(RefusalKind::NotFound, "no verification runs")),
            },
            command => {
                let answer = self.handler()?.answer(command, requester(peer)).await;
                answer.unwrap_or_else(|| {
                    Err(Refusal::new(
                        RefusalKind::Unavailable,
                        "only a daemon can answer this; start one with: tabula run",
                    ))
                })
            }
        }
    }

    fn handler(&mut self) -> Result<&MemoryRequestHandler, Refusal> {
        if self.opened.is_none() {
            self.opened = Some(self.open()?);
        }
        match &self.opened {
            Some((handler, _)) => Ok(handler),
            None => Err(Refusal::new(
                RefusalKind::Internal,
                "the memory is not open",
            )),
        }
    }

    fn open(&self) -> Result<(MemoryRequestHandler, StoreThread), Refusal> {
        let home = self.common.home();
        home.prepare_memories()
            .map_err(|failure| Refusal::new(RefusalKind::Unavailable, failure.to_string()))?;
        let (thread, store, report) = StoreThread::start(StoreConfig {
            folder: home.perceptual_memory(),
            queue_capacity: QUEUE_REQUESTS,
            limits: RetentionLimits {
                // Nothing is moved to the archive, or dropped from it, without the daemon's
                // configuration.
                history: HistoryLimits {
                    kept_entries: u64::MAX,
                    archive_max_bytes: u64::MAX,
                    ..HistoryLimits::CONFIGURED
                },
                ..RetentionLimits::default()
            },
            write_buffer_bytes: WRITE_BUFFER_BYTES,
            wall_clock: || wall_clock_ns().max(0) as u64,
            on_reopened: Box::new(|_| {}),
            on_notice: Box::new(|_| {}),
        })
        .map_err(|error| Refusal::new(RefusalKind::Internal, error.to_string()))?;
        eprintln!("{report}");
        let (handler, _) = MemoryRequestHandler::new(MemoryRequestHandlerConfig {
            store,
            scratch: home.path().join("exchange"),
            uploads: UPLOADS,
            descriptor_kind: learning::DESCRIPTOR_KIND,
        });
        Ok((handler, thread))
    }
}

/// Leaves the store to a daemon of the domain, whose memory may be about to restart: it would
/// find the store in use.
fn refuse_beside_daemon(domain: &DomainName) -> Result<(), Refusal> {
    let runs = |folder: &RunFolder| !DomainState::inspect(domain, folder).running.is_empty();
    if !RunFolder::candidates().iter().any(runs) {
        return Ok(());
    }
    let sentence = format!(
        "a daemon runs in the domain {domain}, but its memory does not answer now, and the store is \
         left to it; ask again in a moment, and see `tabula status`"
    );
    Err(Refusal::new(RefusalKind::Unavailable, sentence))
}

/// Verification of a database that stays closed, on a thread of its own.
#[derive(Default)]
struct Verification {
    done: AtomicU64,
    total: AtomicU64,
    outcome: Mutex<Option<JobOutcome>>,
}

impl Verification {
    fn start(folder: std::path::PathBuf) -> Arc<Self> {
        let shared = Arc::new(Self::default());
        let verification = shared.clone();
        std::thread::spawn(move || {
            let found = perceptual_memory::verify_folder(&folder, |done, total| {
                verification.done.store(done, Ordering::Relaxed);
                verification.total.store(total, Ordering::Relaxed);
            });
            let outcome = match found {
                Ok(found) => JobOutcome::Verified(verification_report(found)),
                Err(error) => JobOutcome::Failed(error.to_string()),
            };
            *verification.lock() = Some(outcome);
        });
        shared
    }

    fn report(&self) -> JobReport {
        JobReport {
            job: VERIFICATION,
            done: self.done.load(Ordering::Relaxed),
            total: self.total.load(Ordering::Relaxed),
            outcome: self.lock().clone(),
        }
    }

    /// The outcome is replaced whole, so a poisoned lock still holds a valid one.
    fn lock(&self) -> std::sync::MutexGuard<'_, Option<JobOutcome>> {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
