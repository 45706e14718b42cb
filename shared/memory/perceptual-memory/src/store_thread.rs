//! Store thread: owns the store and serves a bounded request queue with group commit.
//!
//! A synced write takes milliseconds whether it holds one mutation or fifty. All waiting mutations
//! are therefore staged, written together, and answered together once they are on disk. A read sees
//! all mutations requested before it.
//!
//! An idle store archives its old history and compacts its tables in small steps, so that neither
//! delays a request for long. A store that is never idle archives between two groups.
//!
//! After a failure the pending callers get the error, and the thread reopens the store before the
//! next request. A store that cannot be written, on a full disk for example, is only read, and
//! opened for writing again as soon as that succeeds.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use durable_leveldb::StoreFolder;
use parking_lot::Mutex;

use crate::archiving::ArchivingStep;
use crate::error::{Error, StorageError};
use crate::model::{MutationReceipt, RetentionLimits};
use crate::mutation::Mutation;
use crate::opening::{self, OpenReport};
use crate::perceptual_memory::PerceptualMemory;
use crate::queries::Position;
use crate::read_only;
use crate::reopening_pace::ReopeningPace;

/// Maximum number of requests in one group commit. Chosen; sensitivity: see the bench `teach`.
const GROUP_REQUESTS: usize = 256;
/// Staged bytes above which a group is committed early. Chosen; sensitivity: see the bench `teach`.
const GROUP_BYTES: usize = 4 << 20;
/// Time without requests after which the store compacts.
const IDLE_TIMEOUT: Duration = Duration::from_millis(200);
/// Time between two looks at a running compaction.
const COMPACTION_POLL: Duration = Duration::from_millis(2);
/// Number of filled write buffers that make a compaction worthwhile.
const COMPACTION_BUFFERS: usize = 2;

/// Number of segments by which archiving may fall behind before a busy store does it.
const MAX_SEGMENTS_BEHIND: u64 = 2;
/// Steps of archiving after each group while it has fallen behind. A segment takes one step for
/// each 512 entries and two more, and a group has at most 256 entries.
const STEPS_WHEN_BEHIND: usize = 2;
/// Time without requests between two steps of archiving.
const STEP_PAUSE: Duration = Duration::from_millis(2);
/// Time until archiving is tried again after it failed, for example on a full disk.
const ARCHIVING_RETRY: Duration = Duration::from_secs(60);

/// Callback with a sentence for the log.
pub type OnNotice = Box<dyn FnMut(&str) + Send>;

/// Callback with the report of a store that was reopened after a failure.
pub type OnReopened = Box<dyn FnMut(&Result<OpenReport, Error>) + Send>;

type ReplyCallback<T> = Box<dyn FnOnce(Result<T, Error>) + Send>;

/// Configuration of the store thread.
pub struct StoreConfig {
    /// Folder of the store.
    pub folder: PathBuf,
    /// Capacity of the request queue, at least one.
    pub queue_capacity: usize,
    /// Retention limits.
    pub limits: RetentionLimits,
    /// Size of the write buffer (memtable), bytes; usually
    /// [`WRITE_BUFFER_BYTES`](crate::WRITE_BUFFER_BYTES).
    pub write_buffer_bytes: usize,
    /// Wall clock: nanoseconds since 1970, UTC.
    pub wall_clock: fn() -> u64,
    /// Callback after each reopening, called on the store thread.
    pub on_reopened: OnReopened,
    /// Callback for the log, called on the store thread: history that was dropped for the limit of
    /// the archive, or cannot be archived.
    pub on_notice: OnNotice,
}

impl StoreConfig {
    /// Opens the store, and rebuilds it if `must_rebuild` is set.
    fn open(&self, must_rebuild: bool) -> Result<(PerceptualMemory, OpenReport), Error> {
        let folder = StoreFolder::hold(&self.folder)?.with_write_buffer(self.write_buffer_bytes);
        opening::open(folder, (self.wall_clock)(), self.limits, must_rebuild)
    }

    /// Opens the store for reading after it could not be opened for an error of its disk; otherwise
    /// returns that error.
    fn open_for_reading(&self, error: Error) -> Result<(PerceptualMemory, OpenReport), Error> {
        if !matches!(error, Error::Storage(StorageError::Io(_))) {
            return Err(error);
        }
        let why = ((self.wall_clock)(), error.clone());
        let opened = read_only::open(&self.folder, self.limits, why);
        opened.map_err(|_| error)
    }

    /// Opens the store, for reading only if it cannot be written.
    fn open_if_possible(
        &self,
        must_rebuild: bool,
    ) -> Result<(PerceptualMemory, OpenReport), Error> {
        let opened = self.open(must_rebuild);
        opened.or_else(|error| self.open_for_reading(error))
    }
}

/// Reply callback of one request. It is called exactly once: on the store thread or, for a request
/// that the queue refuses, on the caller's thread.
struct Reply<T>(Option<ReplyCallback<T>>);

impl<T> Reply<T> {
    fn new(answer: impl FnOnce(Result<T, Error>) + Send + 'static) -> Self {
        Self(Some(Box::new(answer)))
    }

    fn send(mut self, result: Result<T, Error>) {
        self.answer(result);
    }

    fn answer(&mut self, result: Result<T, Error>) {
        if let Some(answer) = self.0.take() {
            // A panic in the callback is the caller's, and the panic hook has reported it.
            let _ = catch_unwind(AssertUnwindSafe(|| answer(result)));
        }
    }
}

impl<T> Drop for Reply<T> {
    /// Answers a request that was never served with [`Error::Stopped`].
    fn drop(&mut self) {
        self.answer(Err(Error::Stopped));
    }
}

type Read = Box<dyn FnOnce(Result<&mut PerceptualMemory, Error>) + Send>;

enum StoreRequest {
    Mutate(Mutation, Reply<MutationReceipt>),
    Lease(u64, Reply<u64>),
    Read(Read),
    Rebuild(Reply<OpenReport>),
    Stop,
}

/// Cloneable client handle of the store thread.
#[derive(Clone)]
pub struct StoreHandle {
    /// Request queue. A full queue is an error of the caller. Requests left in it when the thread
    /// ends are dropped, which answers them.
    queue: SyncSender<StoreRequest>,
    capacity: usize,
    position: Arc<Mutex<Position>>,
    is_opening: Arc<AtomicBool>,
    limits: Arc<Mutex<RetentionLimits>>,
}

impl StoreHandle {
    /// Replaces the retention limits, before the next request is served. They are enforced at the
    /// next mutation.
    pub fn set_limits(&self, limits: RetentionLimits) {
        *self.limits.lock() = limits;
    }

    /// `true` while the thread opens the store again after a failure, or rebuilds it; that of a
    /// large store takes minutes.
    pub fn is_opening(&self) -> bool {
        self.is_opening.load(Ordering::Relaxed)
    }

    /// Position of the durable history; does not wait.
    pub fn position(&self) -> Position {
        *self.position.lock()
    }

    /// Requests a mutation; `reply` is called once it is on disk.
    pub fn mutate(
        &self,
        mutation: Mutation,
        reply: impl FnOnce(Result<MutationReceipt, Error>) + Send + 'static,
    ) {
        self.send(StoreRequest::Mutate(mutation, Reply::new(reply)));
    }

    /// Requests a lease of `count` track-ids; `reply` gets the first id once the lease is on disk.
    pub fn lease_track_ids(
        &self,
        count: u64,
        reply: impl FnOnce(Result<u64, Error>) + Send + 'static,
    ) {
        self.send(StoreRequest::Lease(count, Reply::new(reply)));
    }

    /// Runs `read` on the store thread; `reply` gets its result.
    pub fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&mut PerceptualMemory) -> Result<T, Error> + Send + 'static,
        reply: impl FnOnce(Result<T, Error>) + Send + 'static,
    ) {
        let reply = Reply::new(reply);
        self.send(StoreRequest::Read(Box::new(move |memory| {
            reply.send(memory.and_then(read));
        })));
    }

    /// Requests a rebuild from all intact records; `reply` gets the report.
    pub fn rebuild(&self, reply: impl FnOnce(Result<OpenReport, Error>) + Send + 'static) {
        self.send(StoreRequest::Rebuild(Reply::new(reply)));
    }

    /// Requests a mutation and blocks until it is on disk.
    ///
    /// # Errors
    ///
    /// Those of [`PerceptualMemory::apply`], [`Error::QueueFull`], and [`Error::Stopped`].
    pub fn mutate_and_wait(&self, mutation: Mutation) -> Result<MutationReceipt, Error> {
        wait(|reply| self.mutate(mutation, reply))
    }

    /// Requests a lease of track-ids and blocks until it is on disk.
    ///
    /// # Errors
    ///
    /// As [`Self::mutate_and_wait`].
    pub fn lease_track_ids_and_wait(&self, count: u64) -> Result<u64, Error> {
        wait(|reply| self.lease_track_ids(count, reply))
    }

    /// Runs `read` on the store thread and blocks until it has returned.
    ///
    /// # Errors
    ///
    /// Those of `read`, [`Error::QueueFull`], and [`Error::Stopped`].
    pub fn read_and_wait<T: Send + 'static>(
        &self,
        read: impl FnOnce(&mut PerceptualMemory) -> Result<T, Error> + Send + 'static,
    ) -> Result<T, Error> {
        wait(|reply| self.read(read, reply))
    }

    /// Compacts a part of the store, see [`PerceptualMemory::compact_step`], and blocks until that
    /// has ended. Other requests are served meanwhile.
    ///
    /// # Errors
    ///
    /// Those of [`PerceptualMemory::compact_step`], [`Error::QueueFull`], and [`Error::Stopped`].
    pub fn compact_and_wait(&self, step: usize) -> Result<(), Error> {
        self.read_and_wait(move |memory| memory.compact_step(step))?;
        while self.read_and_wait(|memory| Ok(memory.is_compacting()))? {
            std::thread::sleep(COMPACTION_POLL);
        }
        Ok(())
    }

    /// Enqueues a request, or answers it with an error if the queue is full or closed.
    fn send(&self, request: StoreRequest) {
        match self.queue.try_send(request) {
            // Dropping an unserved request answers it with `Stopped`.
            Ok(()) | Err(TrySendError::Disconnected(_)) => {}
            Err(TrySendError::Full(request)) => {
                request.refuse(&Error::QueueFull {
                    capacity: self.capacity,
                });
            }
        }
    }
}

/// Passes a reply callback to `ask` and blocks until it is called.
fn wait<T: Send + 'static>(ask: impl FnOnce(ReplyCallback<T>)) -> Result<T, Error> {
    let (sender, receiver) = sync_channel(1);
    ask(Box::new(move |result| {
        // The receiver waits below.
        let _ = sender.send(result);
    }));
    receiver.recv().unwrap_or(Err(Error::Stopped))
}

impl StoreRequest {
    fn refuse(self, error: &Error) {
        match self {
            Self::Mutate(_, reply) => reply.send(Err(error.clone())),
            Self::Lease(_, reply) => reply.send(Err(error.clone())),
            Self::Read(read) => read(Err(error.clone())),
            Self::Rebuild(reply) => reply.send(Err(error.clone())),
            Self::Stop => {}
        }
    }
}

/// Owner of the store thread; dropping it stops the thread.
pub struct StoreThread {
    queue: SyncSender<StoreRequest>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

impl StoreThread {
    /// Opens the store and starts its thread.
    ///
    /// # Errors
    ///
    /// Those of [`PerceptualMemory::open`], and [`StorageError::Io`] when there is no
    /// room for a thread.
    pub fn start(config: StoreConfig) -> Result<(Self, StoreHandle, OpenReport), Error> {
        let (memory, report) = config.open_if_possible(false)?;
        let position = Arc::new(Mutex::new(memory.position()));
        let is_opening = Arc::new(AtomicBool::new(false));
        let limits = Arc::new(Mutex::new(config.limits));
        let capacity = config.queue_capacity.max(1);
        let (queue, requests) = sync_channel(capacity);
        let folder = config.folder.clone();
        let mut owner = StoreLoop {
            config,
            memory: Some(memory),
            waiting: Vec::new(),
            n_uncompacted_bytes: 0,
            compaction_step: 0,
            has_archiving: true,
            archiving_failed: None,
            pace: ReopeningPace::default(),
            last_error: None,
            reported: None,
            position: Arc::clone(&position),
            is_opening: Arc::clone(&is_opening),
            limits: Arc::clone(&limits),
        };
        let thread = std::thread::Builder::new()
            .name("store".to_owned())
            .spawn(move || owner.run(&requests))
            .map_err(StorageError::io("starting the thread of", folder))?;
        let handle = StoreHandle {
            queue: queue.clone(),
            capacity,
            position,
            is_opening,
            limits,
        };
        Ok((
            Self {
                queue,
                thread: Some(thread),
            },
            handle,
            report,
        ))
    }

    /// Serves the queued requests, closes the store, and ends the thread. Later requests are
    /// answered with [`Error::Stopped`].
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`] when the store could not be closed; what was acknowledged is
    /// on disk all the same.
    pub fn stop(mut self) -> Result<(), Error> {
        self.stop_and_join()
    }

    fn stop_and_join(&mut self) -> Result<(), Error> {
        let Some(thread) = self.thread.take() else {
            return Ok(());
        };
        // Fails only when the thread has ended already.
        let _ = self.queue.send(StoreRequest::Stop);
        thread.join().unwrap_or(Err(Error::Stopped))
    }
}

impl Drop for StoreThread {
    fn drop(&mut self) {
        let _ = self.stop_and_join();
    }
}

/// Request loop of the store thread.
struct StoreLoop {
    config: StoreConfig,
    /// Store; `None` after a failure that reopening did not cure.
    memory: Option<PerceptualMemory>,
    /// Callbacks of staged requests, called after the commit.
    waiting: Vec<ReplyCallback<()>>,
    n_uncompacted_bytes: usize,
    /// Index of the running compaction's next step.
    compaction_step: usize,
    /// `true` if the last step of archiving had work.
    has_archiving: bool,
    /// Time of the last failure of archiving.
    archiving_failed: Option<Instant>,
    /// Pace of the attempts to open a failed store, or one that can only be read.
    pace: ReopeningPace,
    /// Error of the last attempt to open the store, if it failed.
    last_error: Option<Error>,
    /// Last report of trouble; `None` when there is none.
    reported: Option<String>,
    /// Position of the durable history, shared with all handles.
    position: Arc<Mutex<Position>>,
    /// `true` while the store is opened again, shared with all handles.
    is_opening: Arc<AtomicBool>,
    /// Newest retention limits, shared with all handles.
    limits: Arc<Mutex<RetentionLimits>>,
}

impl StoreLoop {
    fn run(&mut self, requests: &Receiver<StoreRequest>) -> Result<(), Error> {
        loop {
            let pause = if self.has_archiving {
                STEP_PAUSE
            } else {
                IDLE_TIMEOUT
            };
            let request = match requests.recv_timeout(pause) {
                Ok(request) => request,
                Err(RecvTimeoutError::Timeout) => {
                    self.take_limits();
                    self.work_when_idle();
                    continue;
                }
                Err(RecvTimeoutError::Disconnected) => break,
            };
            let others = requests.try_iter().take(GROUP_REQUESTS - 1);
            for request in std::iter::once(request).chain(others) {
                if matches!(request, StoreRequest::Stop) {
                    return self.stop();
                }
                self.serve(request);
            }
            self.commit();
            self.archive_when_behind();
        }
        self.stop()
    }

    /// Takes retention limits that were replaced.
    fn take_limits(&mut self) {
        let limits = *self.limits.lock();
        if limits == self.config.limits {
            return;
        }
        self.config.limits = limits;
        if let Some(memory) = &mut self.memory {
            memory.set_limits(limits);
        }
        self.has_archiving = true;
    }

    /// Does one step of archiving, or else of compaction.
    fn work_when_idle(&mut self) {
        if self
            .memory
            .as_ref()
            .is_none_or(PerceptualMemory::is_read_only)
        {
            self.has_archiving = false;
            return;
        }
        self.archive();
        if !self.has_archiving {
            self.compact_when_idle();
            self.record_size();
        }
    }

    /// Does some steps of archiving if a busy store has fallen behind with it: enough to catch up,
    /// since a group adds fewer entries than they archive.
    fn archive_when_behind(&mut self) {
        let limits = &self.config.limits.history;
        let slack = limits.segment_entries.saturating_mul(MAX_SEGMENTS_BEHIND);
        let most = limits.kept_entries.saturating_add(slack);
        for _ in 0..STEPS_WHEN_BEHIND {
            let Some(memory) = &self.memory else { return };
            self.has_archiving |= memory.is_archiving_due();
            if memory.n_recent_entries() <= most {
                return;
            }
            self.archive();
        }
    }

    fn record_size(&mut self) {
        let wall_ns = (self.config.wall_clock)();
        if let Some(memory) = self.memory.as_mut().filter(|m| m.failure().is_none()) {
            // A failure makes the store unusable, which the next request finds.
            let _ = memory.record_size_when_due(wall_ns);
        }
    }

    fn archive(&mut self) {
        self.has_archiving = false;
        let is_pausing = |failed: Instant| failed.elapsed() < ARCHIVING_RETRY;
        let Some(memory) = self.memory.as_mut().filter(|m| m.failure().is_none()) else {
            return;
        };
        if self.archiving_failed.is_some_and(is_pausing) {
            return;
        }
        match memory.archive_step() {
            Ok(ArchivingStep::Idle) => {}
            Ok(ArchivingStep::Done) => self.has_archiving = true,
            Ok(ArchivingStep::Dropped { first, last }) => {
                self.has_archiving = true;
                (self.config.on_notice)(&format!(
                    "history entries {first} to {last} were dropped, since the archive is larger \
                     than [memory] history_archive_max_mb"
                ));
            }
            Err(error) => {
                self.archiving_failed = Some(Instant::now());
                (self.config.on_notice)(&format!(
                    "old history could not be archived and stays in the database: {error}"
                ));
            }
        }
    }

    /// Starts one compaction step if enough was written since the last compaction: of the small
    /// records, and of all content if much of it is garbage.
    fn compact_when_idle(&mut self) {
        let Some(memory) = &mut self.memory else {
            return;
        };
        let buffer_bytes = self.config.write_buffer_bytes;
        let is_due = self.n_uncompacted_bytes >= COMPACTION_BUFFERS * buffer_bytes;
        if !is_due || memory.failure().is_some() || memory.is_compacting() {
            return;
        }
        // A failure makes the store unusable, which the next request finds.
        if memory.compact_step(self.compaction_step).is_err() {
            return;
        }
        self.compaction_step += 1;
        let is_over = match self.compaction_step {
            PerceptualMemory::N_RECORD_STEPS => !memory.has_much_garbage(buffer_bytes as u64),
            step => step == PerceptualMemory::N_COMPACT_STEPS,
        };
        if is_over {
            (self.compaction_step, self.n_uncompacted_bytes) = (0, 0);
        }
    }

    fn serve(&mut self, request: StoreRequest) {
        self.take_limits();
        if let Err(error) = self.open_if_failed() {
            return request.refuse(&error);
        }
        let Some(memory) = &mut self.memory else {
            return request.refuse(&Error::Stopped);
        };
        match request {
            StoreRequest::Mutate(mutation, reply) => {
                let staged = memory.stage(&mutation);
                self.answer_when_committed(reply, staged);
            }
            StoreRequest::Lease(count, reply) => {
                let staged = memory.stage_lease(count);
                self.answer_when_committed(reply, staged);
            }
            StoreRequest::Read(read) => {
                self.commit();
                let memory = self.memory.as_mut().ok_or(Error::Stopped);
                let usable = memory.and_then(|memory| memory.usable().map(|()| memory));
                if catch_unwind(AssertUnwindSafe(|| read(usable))).is_err() {
                    // The state is unknown after a panic: the store is reopened.
                    self.memory = None;
                }
            }
            StoreRequest::Rebuild(reply) => {
                self.commit();
                let report = self.open_again(true);
                reply.send(report.and_then(|report| {
                    let memory = self.memory.as_ref().ok_or(Error::Stopped)?;
                    memory.writable().map(|()| report)
                }));
            }
            StoreRequest::Stop => {}
        }
    }

    /// Queues the answer until the next commit. A refusal waits too, since it may depend on a
    /// staged mutation.
    fn answer_when_committed<T: Send + 'static>(
        &mut self,
        reply: Reply<T>,
        staged: Result<T, Error>,
    ) {
        self.waiting
            .push(Box::new(move |committed: Result<(), Error>| {
                reply.send(committed.and(staged));
            }));
        let n_bytes = self
            .memory
            .as_ref()
            .map_or(0, PerceptualMemory::n_staged_bytes);
        if n_bytes > GROUP_BYTES {
            self.commit();
        }
    }

    /// Commits all staged mutations and answers their callers.
    fn commit(&mut self) {
        if self.waiting.is_empty() {
            return;
        }
        let committed = match &mut self.memory {
            Some(memory) => {
                self.n_uncompacted_bytes += memory.n_staged_bytes();
                memory.commit()
            }
            None => Err(Error::Stopped),
        };
        self.publish_position();
        for answer in self.waiting.drain(..) {
            answer(committed.clone());
        }
    }

    fn publish_position(&self) {
        if let Some(memory) = self.memory.as_ref().filter(|m| m.failure().is_none()) {
            *self.position.lock() = memory.position();
        }
    }

    /// Reopens a failed store, or one that can only be read, when that is due; rebuilds a damaged
    /// one. An error when there is nothing to read.
    fn open_if_failed(&mut self) -> Result<(), Error> {
        let failure = self.memory.as_ref().and_then(PerceptualMemory::failure);
        let is_readable = self.memory.is_some() && failure.is_none();
        let is_writable = self.memory.as_ref().is_some_and(|m| !m.is_read_only());
        if is_readable && is_writable {
            return Ok(());
        }
        let is_damage =
            |error: &Error| matches!(error, Error::Storage(StorageError::Damaged { .. }));
        let must_rebuild = failure.is_some_and(is_damage);
        self.commit();
        if self.pace.is_due(Instant::now()) {
            return self.open_again(must_rebuild).map(|_| ());
        }
        match &self.last_error {
            Some(error) if !is_readable => Err(error.clone()),
            _ => Ok(()),
        }
    }

    fn open_again(&mut self, must_rebuild: bool) -> Result<OpenReport, Error> {
        // Closed first, to release the lock of the folder.
        self.memory = None;
        self.is_opening.store(true, Ordering::Relaxed);
        let began = Instant::now();
        let report = self.config.open_if_possible(must_rebuild);
        let report = report.map(|(memory, report)| {
            self.memory = Some(memory);
            report
        });
        self.is_opening.store(false, Ordering::Relaxed);
        self.publish_position();
        if report.as_ref().is_ok_and(|report| !report.is_read_only()) {
            self.pace.succeeded();
        } else {
            self.pace.failed(began, Instant::now());
        }
        self.tell(&report);
        report
    }

    /// Reports an attempt to open the store, unless it failed in the same way as the one before.
    fn tell(&mut self, report: &Result<OpenReport, Error>) {
        let trouble = match report {
            Ok(report) => report.is_read_only().then(|| report.to_string()),
            Err(error) => Some(error.to_string()),
        };
        self.last_error = report.as_ref().err().cloned();
        let is_news = trouble.is_none() || trouble != self.reported;
        self.reported = trouble;
        if is_news {
            (self.config.on_reopened)(report);
        }
    }

    fn stop(&mut self) -> Result<(), Error> {
        self.commit();
        match self.memory.take() {
            Some(memory) => memory.close(),
            None => Ok(()),
        }
    }
}
