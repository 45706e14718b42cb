//! Worker pool with a watchdog: threads for compute kernels, separate from the
//! reactor's.
//!
//! A job that shows no progress for the stall time is declared lost; its thread is
//! abandoned (a thread cannot be killed safely) and replaced. After a few of these
//! the pool is exhausted: it answers every job with an error, and the process should
//! exit.

use std::fmt;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam::channel::{self, Receiver, Sender};
use parking_lot::Mutex;
use tokio::sync::watch;

use crate::error::Error;
use crate::job::{Job, JobResult, Task};
use crate::progress::Progress;
use worker_watch::{WatchedWorker, Worker};

pub use crate::job::JobLost;
pub use fork_join::ForkJoin;

mod fork_join;
mod worker_watch;

/// Number of watchdog checks within one stall time.
const CHECKS_PER_STALL: u32 = 4;

/// Shortest period of the watchdog, whatever the configuration.
const SHORTEST_PERIOD: Duration = Duration::from_millis(1);
/// Longest period of the watchdog, after which another stall time counts.
const LONGEST_PERIOD: Duration = Duration::from_millis(500);

/// Pool configuration: number of workers and stall limits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PoolConfig {
    /// Prefix of the threads' names; Linux shows the first 15 bytes of a name.
    pub name: String,
    /// Number of worker threads in the pool.
    pub n_workers: NonZeroUsize,
    /// Stall time: a job without progress for this long is abandoned.
    pub stall_after: Duration,
    /// Number of abandoned workers at which the pool is exhausted.
    pub max_abandoned: NonZeroUsize,
}

/// Fixed-size pool of named threads; cheap to clone. When the last clone is dropped,
/// the workers end after the jobs already queued.
#[derive(Clone)]
pub struct WorkerPool(Arc<PoolState>);

struct PoolState {
    config: PoolConfig,
    /// Stall time in use, nanoseconds.
    stall_after_ns: AtomicU64,
    /// Unbounded, but each entry has a task awaiting it, which bounds it.
    queue: Sender<Arc<dyn Task>>,
    workers: Mutex<WorkerSet>,
    n_abandoned: AtomicUsize,
    exhausted: watch::Sender<bool>,
}

struct WorkerSet {
    watched: Vec<WatchedWorker>,
    queue: Receiver<Arc<dyn Task>>,
    n_started: usize,
    checked_at: Option<Instant>,
}

impl WorkerPool {
    /// Starts the threads. They are not watched until
    /// [`start_watchdog`](Self::start_watchdog) or [`check`](Self::check).
    ///
    /// # Errors
    /// [`Error::ThreadNotStarted`]; threads already started end again.
    pub fn start(config: PoolConfig) -> Result<Self, Error> {
        let (sender, receiver) = channel::unbounded();
        let mut workers = WorkerSet {
            watched: Vec::new(),
            queue: receiver,
            n_started: 0,
            checked_at: None,
        };
        for _ in 0..config.n_workers.get() {
            workers.start_worker(&config.name, Instant::now())?;
        }
        Ok(Self(Arc::new(PoolState {
            stall_after_ns: AtomicU64::new(nanoseconds(config.stall_after)),
            config,
            queue: sender,
            workers: Mutex::new(workers),
            n_abandoned: AtomicUsize::new(0),
            exhausted: watch::Sender::new(false),
        })))
    }

    /// Starts the watchdog thread, which checks the workers several times within each
    /// stall time for as long as the pool lives.
    ///
    /// # Errors
    /// [`Error::ThreadNotStarted`].
    pub fn start_watchdog(&self) -> Result<(), Error> {
        let mut period = self.check_period();
        let pool = Arc::downgrade(&self.0);
        start_thread(format!("{}-dog", self.0.config.name), move || {
            loop {
                thread::sleep(period);
                let Some(shared) = pool.upgrade() else {
                    return;
                };
                let pool = Self(shared);
                pool.check(Instant::now());
                period = pool.check_period();
            }
        })
    }

    /// Replaces the stall time, within half a second.
    pub fn set_stall_after(&self, stall_after: Duration) {
        let stall_after_ns = nanoseconds(stall_after);
        self.0
            .stall_after_ns
            .store(stall_after_ns, Ordering::Relaxed);
    }

    fn stall_after(&self) -> Duration {
        Duration::from_nanos(self.0.stall_after_ns.load(Ordering::Relaxed))
    }

    fn check_period(&self) -> Duration {
        (self.stall_after() / CHECKS_PER_STALL).clamp(SHORTEST_PERIOD, LONGEST_PERIOD)
    }

    /// Runs a closure on a worker and returns the future of its result. Dropping the
    /// future before the closure began cancels it.
    ///
    /// # Errors
    /// [`JobLost`] when it panicked, stalled, or the pool is exhausted.
    pub fn run<F, T>(&self, work: F) -> impl Future<Output = Result<T, JobLost>> + Send + use<F, T>
    where
        F: FnOnce(&Progress) -> T + Send + 'static,
        T: Send + 'static,
    {
        let job = Arc::new(Job::new(work));
        // The pool holds a receiver, so the channel cannot be disconnected.
        let _ = self.0.queue.send(Arc::clone(&job) as Arc<dyn Task>);
        // Checked after queueing: either this sees the exhaustion, or the exhaustion
        // sees the job.
        if self.is_exhausted() {
            job.mark_lost(JobLost::Exhausted);
        }
        JobResult(job)
    }

    /// Creates a fork-join helper for work of a job that other workers can share. A
    /// leader or a helper that stalls is abandoned like any other worker, and the job
    /// with it.
    ///
    /// The worker threads live as long as it does.
    pub fn fork_join(&self) -> ForkJoin {
        let queue = self.0.queue.clone();
        let call = move |helper: Arc<fork_join::Helper>| {
            // The pool holds a receiver; without one there would be no help.
            let _ = queue.send(helper as Arc<dyn Task>);
        };
        ForkJoin::new(self.0.config.n_workers.get() - 1, Box::new(call))
    }

    /// Watchdog check: abandons and replaces each worker that has shown no progress
    /// for the stall time before `now`; returns their number. Call it several times
    /// within a stall time: a longer gap between two calls (the process was stopped)
    /// proves nothing about the workers, and restarts their clocks.
    pub fn check(&self, now: Instant) -> usize {
        let mut unstarted = Vec::new();
        let n_stalled = {
            let mut workers = self.0.workers.lock();
            let n_stalled = workers.remove_stalled(now, self.stall_after());
            for _ in 0..n_stalled {
                if !self.replace_one(&mut workers, now) {
                    self.0.exhausted.send_replace(true);
                    unstarted.extend(workers.queue.try_iter());
                }
            }
            n_stalled
        };
        for task in unstarted {
            task.mark_lost(JobLost::Exhausted);
        }
        n_stalled
    }

    /// Counts an abandoned worker and starts its successor; `false` when there is
    /// none, because too many were lost or the system refuses a thread.
    fn replace_one(&self, workers: &mut WorkerSet, now: Instant) -> bool {
        let n_abandoned = self.0.n_abandoned.fetch_add(1, Ordering::Relaxed) + 1;
        n_abandoned < self.0.config.max_abandoned.get()
            && workers.start_worker(&self.0.config.name, now).is_ok()
    }

    /// Number of workers abandoned since the start.
    pub fn n_abandoned(&self) -> usize {
        self.0.n_abandoned.load(Ordering::Relaxed)
    }

    /// `true` when too many workers were abandoned, or one could not be replaced.
    pub fn is_exhausted(&self) -> bool {
        *self.0.exhausted.borrow()
    }

    /// Returns when the pool is exhausted: then the process should end with an error,
    /// because the abandoned threads hold memory and shared frames.
    pub async fn exhausted(&self) {
        let mut exhausted = self.0.exhausted.subscribe();
        // Cannot fail: the sender lives as long as `self`.
        let _ = exhausted.wait_for(|is_exhausted| *is_exhausted).await;
    }
}

impl WorkerSet {
    fn start_worker(&mut self, name: &str, now: Instant) -> Result<(), Error> {
        let thread = Arc::new(Worker::default());
        let (own, queue) = (Arc::clone(&thread), self.queue.clone());
        start_thread(format!("{name}-{}", self.n_started), move || {
            work(&own, &queue);
        })?;
        self.n_started += 1;
        self.watched.push(WatchedWorker::new(thread, now));
        Ok(())
    }

    fn remove_stalled(&mut self, now: Instant, stall_after: Duration) -> usize {
        let previous = self.checked_at.replace(now);
        let was_watched =
            previous.is_some_and(|then| now.saturating_duration_since(then) <= stall_after);
        let n_before = self.watched.len();
        self.watched.retain_mut(|worker| {
            let silent = worker.silent_job(now);
            let stalled = silent.filter(|(_, time)| was_watched && *time >= stall_after);
            !stalled.is_some_and(|(task, _)| task.mark_lost(JobLost::Stalled))
        });
        if !was_watched {
            self.watched
                .iter_mut()
                .for_each(|worker| worker.forget_silence(now));
        }
        n_before - self.watched.len()
    }
}

/// Runs the queued jobs until the pool ends or the watchdog has replaced this worker.
fn work(worker: &Worker, queue: &Receiver<Arc<dyn Task>>) {
    while let Ok(task) = queue.recv() {
        if !worker.run(&task) {
            return;
        }
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

fn start_thread(name: String, body: impl FnOnce() + Send + 'static) -> Result<(), Error> {
    match thread::Builder::new().name(name.clone()).spawn(body) {
        Ok(_detached) => Ok(()),
        Err(source) => Err(Error::ThreadNotStarted { name, source }),
    }
}

impl fmt::Debug for WorkerPool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WorkerPool")
            .field("config", &self.0.config)
            .field("abandoned", &self.n_abandoned())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
