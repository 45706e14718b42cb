//! The thread that owns the store, and the queue in front of it.
//!
//! A synced write takes milliseconds whether it holds one change or fifty, so
//! all changes that wait are staged one after the other, written together, and
//! answered together when they are on disk. A read sees all changes asked for
//! before it.
//!
//! When nobody asks for anything, the tables are merged in small steps, so that
//! this need not be done while somebody waits.
//!
//! When the store fails, the callers of that moment get the error, and the
//! thread opens it again before the next request.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::economy::Limits;
use crate::error::Error;
use crate::mutation::{Answer, Mutation};
use crate::opening::{self, OpenReport};
use crate::perceptual_memory::PerceptualMemory;
use crate::reading::Position;
use crate::store_folder::StoreFolder;

/// Most requests taken from the queue before what they changed is written.
const GROUP_REQUESTS: usize = 256;
/// Most bytes gathered before they are written.
const GROUP_BYTES: usize = 4 << 20;
/// Without requests for this long the store tidies up.
const IDLE: Duration = Duration::from_millis(200);
/// As many write buffers filled since the last tidying are worth another.
const TIDY_BUFFERS: usize = 2;

/// Told what was found when the store was opened again.
pub type OnReopened = Box<dyn FnMut(&Result<OpenReport, Error>) + Send>;

type Answering<T> = Box<dyn FnOnce(Result<T, Error>) + Send>;

/// How to run the store.
pub struct StoreConfig {
    /// The store's folder.
    pub folder: PathBuf,
    /// Most requests that may wait, at least one.
    pub queue_capacity: usize,
    /// How much is kept.
    pub limits: Limits,
    /// What is gathered in memory before the database makes a table of it, usually
    /// [`WRITE_BUFFER_BYTES`](crate::WRITE_BUFFER_BYTES).
    pub write_buffer_bytes: usize,
    /// Now, nanoseconds since 1970, UTC.
    pub wall_clock: fn() -> u64,
    /// Told, on the store's thread, what was found whenever the store had to be
    /// opened again.
    pub on_reopened: OnReopened,
}

impl StoreConfig {
    /// Opens the store; a damaged one is rebuilt when asked for.
    fn open(&self, must_rebuild: bool) -> Result<(PerceptualMemory, OpenReport), Error> {
        let folder = StoreFolder::hold(&self.folder)?.with_write_buffer(self.write_buffer_bytes);
        let (mut memory, report) = opening::open(folder, (self.wall_clock)(), must_rebuild)?;
        memory.set_limits(self.limits);
        Ok((memory, report))
    }
}

/// Takes the answer to one request; called exactly once, on the store's thread
/// or, when the request is not taken, on the caller's.
struct Reply<T>(Option<Answering<T>>);

impl<T> Reply<T> {
    fn new(answer: impl FnOnce(Result<T, Error>) + Send + 'static) -> Self {
        Self(Some(Box::new(answer)))
    }

    fn send(mut self, result: Result<T, Error>) {
        self.answer(result);
    }

    fn answer(&mut self, result: Result<T, Error>) {
        if let Some(answer) = self.0.take() {
            // A panic in there is the caller's, and has been told by the panic hook.
            let _ = catch_unwind(AssertUnwindSafe(|| answer(result)));
        }
    }
}

impl<T> Drop for Reply<T> {
    /// A request that nobody served is answered too.
    fn drop(&mut self) {
        self.answer(Err(Error::Stopped));
    }
}

type Read = Box<dyn FnOnce(Result<&mut PerceptualMemory, Error>) + Send>;

enum Request {
    Mutate(Mutation, Reply<Answer>),
    Lease(u64, Reply<u64>),
    Read(Read),
    Rebuild(Reply<OpenReport>),
    Stop,
}

/// Sends requests to the store; clones send to the same.
#[derive(Clone)]
pub struct StoreHandle {
    /// A full queue is the caller's error. What is in it when the thread ends is
    /// dropped, and dropping answers it.
    queue: SyncSender<Request>,
    capacity: usize,
    position: Arc<Mutex<Position>>,
}

impl StoreHandle {
    /// What is on disk now; nobody waits for it.
    pub fn position(&self) -> Position {
        *self.position.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks for a change; `reply` gets the answer when it is on disk.
    pub fn mutate(
        &self,
        mutation: Mutation,
        reply: impl FnOnce(Result<Answer, Error>) + Send + 'static,
    ) {
        self.send(Request::Mutate(mutation, Reply::new(reply)));
    }

    /// Asks for `count` track-ids; `reply` gets the first when the lease is on disk.
    pub fn lease_track_ids(
        &self,
        count: u64,
        reply: impl FnOnce(Result<u64, Error>) + Send + 'static,
    ) {
        self.send(Request::Lease(count, Reply::new(reply)));
    }

    /// Has `read` run on the store's thread; `reply` gets what it returned.
    pub fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&mut PerceptualMemory) -> Result<T, Error> + Send + 'static,
        reply: impl FnOnce(Result<T, Error>) + Send + 'static,
    ) {
        let reply = Reply::new(reply);
        self.send(Request::Read(Box::new(move |memory| {
            reply.send(memory.and_then(read));
        })));
    }

    /// Has the store made anew from what is whole in it; `reply` gets what was found.
    pub fn rebuild(&self, reply: impl FnOnce(Result<OpenReport, Error>) + Send + 'static) {
        self.send(Request::Rebuild(Reply::new(reply)));
    }

    /// As [`Self::mutate`], and waits for the answer.
    ///
    /// # Errors
    ///
    /// Those of [`PerceptualMemory::apply`], [`Error::QueueFull`], and [`Error::Stopped`].
    pub fn mutate_and_wait(&self, mutation: Mutation) -> Result<Answer, Error> {
        wait(|reply| self.mutate(mutation, reply))
    }

    /// As [`Self::lease_track_ids`], and waits for the answer.
    ///
    /// # Errors
    ///
    /// As [`Self::mutate_and_wait`].
    pub fn lease_track_ids_and_wait(&self, count: u64) -> Result<u64, Error> {
        wait(|reply| self.lease_track_ids(count, reply))
    }

    /// As [`Self::read`], and waits for the answer.
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

    /// Puts a request into the queue, or answers it with why not.
    fn send(&self, request: Request) {
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

/// Hands `ask` a reply and waits until it is used.
fn wait<T: Send + 'static>(ask: impl FnOnce(Answering<T>)) -> Result<T, Error> {
    let (sender, receiver) = sync_channel(1);
    ask(Box::new(move |result| {
        // The receiver is waiting below.
        let _ = sender.send(result);
    }));
    receiver.recv().unwrap_or(Err(Error::Stopped))
}

impl Request {
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

/// Owns the thread; stops it when dropped.
pub struct StoreThread {
    queue: SyncSender<Request>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

impl StoreThread {
    /// Opens the store and starts its thread.
    ///
    /// # Errors
    ///
    /// Those of [`PerceptualMemory::open`], and [`Error::Io`] when there is no
    /// room for a thread.
    pub fn start(config: StoreConfig) -> Result<(Self, StoreHandle, OpenReport), Error> {
        let (memory, report) = config.open(false)?;
        let position = Arc::new(Mutex::new(memory.position()));
        let capacity = config.queue_capacity.max(1);
        let (queue, requests) = sync_channel(capacity);
        let folder = config.folder.clone();
        let mut owner = Owner {
            config,
            memory: Some(memory),
            waiting: Vec::new(),
            n_untidy_bytes: 0,
            tidy_step: 0,
            position: Arc::clone(&position),
        };
        let thread = std::thread::Builder::new()
            .name("store".to_owned())
            .spawn(move || owner.run(&requests))
            .map_err(Error::io("starting the thread of", folder))?;
        let handle = StoreHandle {
            queue: queue.clone(),
            capacity,
            position,
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

    /// Serves what waits already, closes the store, and ends the thread; later
    /// requests are answered with [`Error::Stopped`].
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the store could not be closed; what was acknowledged is
    /// on disk all the same.
    pub fn stop(mut self) -> Result<(), Error> {
        self.stop_and_join()
    }

    fn stop_and_join(&mut self) -> Result<(), Error> {
        let Some(thread) = self.thread.take() else {
            return Ok(());
        };
        // Fails only when the thread has ended already.
        let _ = self.queue.send(Request::Stop);
        thread.join().unwrap_or(Err(Error::Stopped))
    }
}

impl Drop for StoreThread {
    fn drop(&mut self) {
        let _ = self.stop_and_join();
    }
}

/// What runs on the thread.
struct Owner {
    config: StoreConfig,
    /// None when it failed and could not be opened again.
    memory: Option<PerceptualMemory>,
    /// Answers to be given when what is staged is on disk, or is not.
    waiting: Vec<Answering<()>>,
    n_untidy_bytes: usize,
    /// The next step of the tidying under way.
    tidy_step: usize,
    /// What is on disk, for all handles.
    position: Arc<Mutex<Position>>,
}

impl Owner {
    fn run(&mut self, requests: &Receiver<Request>) -> Result<(), Error> {
        loop {
            let request = match requests.recv_timeout(IDLE) {
                Ok(request) => request,
                Err(RecvTimeoutError::Timeout) => {
                    self.tidy();
                    continue;
                }
                Err(RecvTimeoutError::Disconnected) => break,
            };
            let others = requests.try_iter().take(GROUP_REQUESTS - 1);
            for request in std::iter::once(request).chain(others) {
                if matches!(request, Request::Stop) {
                    return self.stop();
                }
                self.serve(request);
            }
            self.commit();
        }
        self.stop()
    }

    /// Makes one step of merging the tables, when much was written since the last time.
    fn tidy(&mut self) {
        let Some(memory) = &mut self.memory else {
            return;
        };
        let worth_it = TIDY_BUFFERS * self.config.write_buffer_bytes;
        if self.n_untidy_bytes < worth_it || memory.failure().is_some() {
            return;
        }
        // A failure makes the store unusable, which the next request finds.
        if memory.compact_step(self.tidy_step).is_err() {
            return;
        }
        self.tidy_step += 1;
        if self.tidy_step == PerceptualMemory::N_COMPACT_STEPS {
            (self.tidy_step, self.n_untidy_bytes) = (0, 0);
        }
    }

    fn serve(&mut self, request: Request) {
        if let Err(error) = self.open_if_failed() {
            return request.refuse(&error);
        }
        let Some(memory) = &mut self.memory else {
            return request.refuse(&Error::Stopped);
        };
        match request {
            Request::Mutate(mutation, reply) => {
                let staged = memory.stage(&mutation);
                self.answer_when_committed(reply, staged);
            }
            Request::Lease(count, reply) => {
                let staged = memory.stage_lease(count);
                self.answer_when_committed(reply, staged);
            }
            Request::Read(read) => {
                self.commit();
                let memory = self.memory.as_mut().ok_or(Error::Stopped);
                let usable = memory.and_then(|memory| memory.usable().map(|()| memory));
                if catch_unwind(AssertUnwindSafe(|| read(usable))).is_err() {
                    // Who knows in the middle of what: it is opened again.
                    self.memory = None;
                }
            }
            Request::Rebuild(reply) => {
                self.commit();
                reply.send(self.open_again(true));
            }
            Request::Stop => {}
        }
    }

    /// Even a refusal waits: it may rest on a change that is not on disk yet.
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

    /// Has what is staged on disk, and answers everybody who waits for it.
    fn commit(&mut self) {
        if self.waiting.is_empty() {
            return;
        }
        let committed = match &mut self.memory {
            Some(memory) => {
                self.n_untidy_bytes += memory.n_staged_bytes();
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
            let mut position = self.position.lock().unwrap_or_else(PoisonError::into_inner);
            *position = memory.position();
        }
    }

    /// Opens a failed store again; a damaged one is rebuilt.
    fn open_if_failed(&mut self) -> Result<(), Error> {
        let must_rebuild = match &self.memory {
            Some(memory) => match memory.failure() {
                None => return Ok(()),
                Some(error) => matches!(error, Error::Damaged { .. }),
            },
            None => false,
        };
        self.commit();
        self.open_again(must_rebuild).map(|_| ())
    }

    fn open_again(&mut self, must_rebuild: bool) -> Result<OpenReport, Error> {
        // Closed first: it holds the folder.
        self.memory = None;
        let report = self.config.open(must_rebuild).map(|(memory, report)| {
            self.memory = Some(memory);
            report
        });
        self.publish_position();
        (self.config.on_reopened)(&report);
        report
    }

    fn stop(&mut self) -> Result<(), Error> {
        self.commit();
        match self.memory.take() {
            Some(memory) => memory.close(),
            None => Ok(()),
        }
    }
}
