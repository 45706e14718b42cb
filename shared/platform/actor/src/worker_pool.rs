//! Own threads for the kernels, away from the reactor's.
//!
//! A job that shows no progress for the stall time is declared lost, its thread
//! left behind (a thread cannot be killed safely) and replaced. After a few of
//! these the pool is exhausted: it answers every job with an error, and the
//! process should exit.

use std::fmt;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam::channel::{self, Receiver, Sender};
use tokio::sync::watch;

use crate::error::Error;
use crate::job::{Job, JobResult, Task};
use crate::progress::Progress;

pub use crate::job::JobLost;
pub use team::Team;

mod team;

/// The watchdog looks this often within one stall time.
const CHECKS_PER_STALL: u32 = 4;

/// It never spins, however impatient the configuration.
const SHORTEST_PERIOD: Duration = Duration::from_millis(1);

/// How many workers, and how patient the pool is with them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PoolConfig {
    /// Begins the threads' names; Linux shows the first 15 bytes of a name.
    pub name: String,
    /// Threads at work at any time.
    pub n_workers: NonZeroUsize,
    /// A job silent for this long is abandoned.
    pub stall_after: Duration,
    /// With this many workers abandoned the pool is exhausted.
    pub max_abandoned: NonZeroUsize,
}

/// A fixed crew of named threads; cheap to clone. When the last clone is
/// dropped, the workers end after the jobs already queued.
#[derive(Clone)]
pub struct WorkerPool(Arc<Shared>);

struct Shared {
    config: PoolConfig,
    /// Unbounded, but each entry has a task awaiting it: the awaiting side is
    /// what bounds it.
    queue: Sender<Arc<dyn Task>>,
    crew: Mutex<Crew>,
    n_abandoned: AtomicUsize,
    exhausted: watch::Sender<bool>,
}

struct Crew {
    posts: Vec<Post>,
    queue: Receiver<Arc<dyn Task>>,
    n_started: usize,
    checked_at: Option<Instant>,
}

/// One worker as the watchdog knows it.
struct Post {
    worker: Arc<Worker>,
    seen_count: u64,
    silent_since: Instant,
}

/// What a worker's thread and the watchdog share.
#[derive(Default)]
struct Worker {
    progress: Progress,
    at_work: Mutex<Option<Arc<dyn Task>>>,
}

impl WorkerPool {
    /// Starts the threads. Nobody watches them until
    /// [`start_watchdog`](Self::start_watchdog) or [`check`](Self::check).
    ///
    /// # Errors
    /// [`Error::ThreadNotStarted`]; threads already started end again.
    pub fn start(config: PoolConfig) -> Result<Self, Error> {
        let (sender, receiver) = channel::unbounded();
        let mut crew = Crew {
            posts: Vec::new(),
            queue: receiver,
            n_started: 0,
            checked_at: None,
        };
        for _ in 0..config.n_workers.get() {
            crew.start_worker(&config.name, Instant::now())?;
        }
        Ok(Self(Arc::new(Shared {
            config,
            queue: sender,
            crew: Mutex::new(crew),
            n_abandoned: AtomicUsize::new(0),
            exhausted: watch::Sender::new(false),
        })))
    }

    /// Starts a thread that checks the workers several times within each stall
    /// time, for as long as the pool lives.
    ///
    /// # Errors
    /// [`Error::ThreadNotStarted`].
    pub fn start_watchdog(&self) -> Result<(), Error> {
        let period = (self.0.config.stall_after / CHECKS_PER_STALL).max(SHORTEST_PERIOD);
        let pool = Arc::downgrade(&self.0);
        start_thread(format!("{}-dog", self.0.config.name), move || {
            loop {
                thread::sleep(period);
                match pool.upgrade() {
                    Some(shared) => Self(shared).check(Instant::now()),
                    None => return,
                };
            }
        })
    }

    /// Runs a closure on a worker. Dropping the future before the closure began
    /// means that it never runs.
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
        // Looked at after queueing: either this sees the exhaustion, or the
        // exhaustion sees the job.
        if self.is_exhausted() {
            job.lose(JobLost::Exhausted);
        }
        JobResult(job)
    }

    /// A team for work of a job that other workers can share. A leader or a helper
    /// that stalls is abandoned like any other worker, and the job with it.
    ///
    /// The workers live as long as the team.
    pub fn team(&self) -> Team {
        let queue = self.0.queue.clone();
        let call = move |helper: Arc<team::Helper>| {
            // The pool holds a receiver; without one nobody would help.
            let _ = queue.send(helper as Arc<dyn Task>);
        };
        Team::new(self.0.config.n_workers.get() - 1, Box::new(call))
    }

    /// Abandons and replaces each worker that has shown no progress for the
    /// stall time before `now`; returns how many. Call it several times within
    /// a stall time: a longer gap between two calls (the process was stopped)
    /// proves nothing about the workers, and restarts their clocks.
    pub fn check(&self, now: Instant) -> usize {
        let mut unrun = Vec::new();
        let n_stalled = {
            let mut crew = lock(&self.0.crew);
            let n_stalled = crew.remove_stalled(now, self.0.config.stall_after);
            for _ in 0..n_stalled {
                if !self.replace_one(&mut crew, now) {
                    self.0.exhausted.send_replace(true);
                    unrun.extend(crew.queue.try_iter());
                }
            }
            n_stalled
        };
        for task in unrun {
            task.lose(JobLost::Exhausted);
        }
        n_stalled
    }

    /// Counts an abandoned worker and starts its successor; false when there is
    /// none, because too many were lost or the system gives no thread.
    fn replace_one(&self, crew: &mut Crew, now: Instant) -> bool {
        let n_abandoned = self.0.n_abandoned.fetch_add(1, Ordering::Relaxed) + 1;
        n_abandoned < self.0.config.max_abandoned.get()
            && crew.start_worker(&self.0.config.name, now).is_ok()
    }

    /// How many workers were abandoned since the start.
    pub fn abandoned(&self) -> usize {
        self.0.n_abandoned.load(Ordering::Relaxed)
    }

    /// Whether too many workers were abandoned, or one could not be replaced.
    pub fn is_exhausted(&self) -> bool {
        *self.0.exhausted.borrow()
    }

    /// Returns once the pool is exhausted: then the process should end with an
    /// error, for the threads left behind hold memory and shared frames.
    pub async fn exhausted(&self) {
        let mut exhausted = self.0.exhausted.subscribe();
        // Cannot fail: the sender lives as long as `self`.
        let _ = exhausted.wait_for(|is_exhausted| *is_exhausted).await;
    }
}

impl Crew {
    fn start_worker(&mut self, name: &str, now: Instant) -> Result<(), Error> {
        let worker = Arc::new(Worker::default());
        let (at_post, queue) = (Arc::clone(&worker), self.queue.clone());
        start_thread(format!("{name}-{}", self.n_started), move || {
            at_post.work(&queue);
        })?;
        self.n_started += 1;
        self.posts.push(Post {
            worker,
            seen_count: 0,
            silent_since: now,
        });
        Ok(())
    }

    fn remove_stalled(&mut self, now: Instant, stall_after: Duration) -> usize {
        let previous = self.checked_at.replace(now);
        let was_watched =
            previous.is_some_and(|then| now.saturating_duration_since(then) <= stall_after);
        let n_before = self.posts.len();
        self.posts.retain_mut(|post| {
            let silent = post.silent_task(now);
            let stalled = silent.filter(|(_, time)| was_watched && *time >= stall_after);
            !stalled.is_some_and(|(task, _)| task.lose(JobLost::Stalled))
        });
        if !was_watched {
            self.posts
                .iter_mut()
                .for_each(|post| post.silent_since = now);
        }
        n_before - self.posts.len()
    }
}

impl Post {
    /// The job at work and for how long it has shown no progress.
    fn silent_task(&mut self, now: Instant) -> Option<(Arc<dyn Task>, Duration)> {
        // The job first, then the count: a job that has just begun has ticked.
        let at_work = lock(&self.worker.at_work).clone();
        let count = self.worker.progress.count();
        if at_work.is_none() || count != self.seen_count {
            self.seen_count = count;
            self.silent_since = now;
        }
        Some((at_work?, now.saturating_duration_since(self.silent_since)))
    }
}

impl Worker {
    fn work(&self, queue: &Receiver<Arc<dyn Task>>) {
        while let Ok(task) = queue.recv() {
            // Before the job is visible, so that whoever sees it also sees that
            // its beginning was progress.
            self.progress.tick();
            *lock(&self.at_work) = Some(Arc::clone(&task));
            let is_kept = task.run(&self.progress);
            *lock(&self.at_work) = None;
            if !is_kept {
                return;
            }
        }
    }
}

/// No foreign code runs under these locks, so a poisoned one is still whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
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
            .field("abandoned", &self.abandoned())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
