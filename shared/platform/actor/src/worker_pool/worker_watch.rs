//! Watch of a worker: the job that it runs, and the time since the last progress of that job.

use std::sync::Arc as TaskArc;
use std::time::{Duration, Instant};

use crate::job::Task;
use crate::progress::Progress;
use crate::sync::{Arc, Mutex, PoisonError};

/// State shared by a worker's thread and the watchdog.
#[derive(Default)]
pub(crate) struct Worker {
    progress: Progress,
    current_job: Mutex<Option<TaskArc<dyn Task>>>,
}

impl Worker {
    /// Runs a job that the watchdog can see meanwhile; `false` when it declared the job lost.
    pub(crate) fn run(&self, task: &TaskArc<dyn Task>) -> bool {
        // Before the job is visible, so that a watchdog that sees it also sees
        // its beginning as progress.
        self.progress.tick();
        self.set_job(Some(TaskArc::clone(task)));
        let is_kept = task.run(&self.progress);
        self.set_job(None);
        is_kept
    }

    fn set_job(&self, job: Option<TaskArc<dyn Task>>) {
        *self
            .current_job
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = job;
    }

    fn job(&self) -> Option<TaskArc<dyn Task>> {
        let job = self
            .current_job
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        job.clone()
    }
}

/// Watchdog's record of one worker.
pub(crate) struct WatchedWorker {
    worker: Arc<Worker>,
    last_count: u64,
    last_progress_at: Instant,
}

impl WatchedWorker {
    pub(crate) fn new(worker: Arc<Worker>, now: Instant) -> Self {
        Self {
            worker,
            last_count: 0,
            last_progress_at: now,
        }
    }

    /// Current job and the time since its last progress, as far as the checks have seen.
    pub(crate) fn silent_job(&mut self, now: Instant) -> Option<(TaskArc<dyn Task>, Duration)> {
        // The job first, then the count: a job that has just begun has ticked.
        let current_job = self.worker.job();
        let count = self.worker.progress.count();
        if current_job.is_none() || count != self.last_count {
            self.last_count = count;
            self.last_progress_at = now;
        }
        Some((
            current_job?,
            now.saturating_duration_since(self.last_progress_at),
        ))
    }

    /// Restarts the clock of the worker: nothing is known of the time before.
    pub(crate) fn forget_silence(&mut self, now: Instant) {
        self.last_progress_at = now;
    }
}
