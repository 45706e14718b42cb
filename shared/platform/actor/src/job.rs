//! Job state machine of the worker pool, shared by the worker, the awaiting task and
//! the watchdog that may declare the job lost.

use std::pin::Pin;
use std::task::{Context, Poll, Waker};

use crate::panic_boundary::{catch_panic, drop_caught};
use crate::progress::Progress;
use crate::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Reason for which a job has no result.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum JobLost {
    /// Panic of the job with this message.
    #[error("The job panicked ({0}); its result is lost, and the panic is a bug to fix.")]
    Panicked(String),
    /// The job showed no progress for the stall time. Its thread was abandoned, and
    /// keeps the job's borrows until it moves again.
    #[error(
        "The job showed no progress for the stall time and was abandoned with its \
         thread; shorten it or let it tick."
    )]
    Stalled,
    /// Pool that has abandoned too many workers and takes no more work.
    #[error(
        "The job was not run, because too many workers of the pool have stalled; \
         end the process and let its supervisor start it again."
    )]
    Exhausted,
}

/// Type-erased job: the pool's view, independent of the result type.
pub(crate) trait Task: Send + Sync {
    /// Runs the work on this thread. `false` when the watchdog has declared it lost
    /// meanwhile: this thread has then been replaced.
    fn run(&self, progress: &Progress) -> bool;

    /// Declares the job lost. `false` when it had already ended.
    fn mark_lost(&self, reason: JobLost) -> bool;
}

pub(crate) struct Job<F, T>(Mutex<JobState<F, T>>);

enum JobState<F, T> {
    Queued(F, Option<Waker>),
    Running(Option<Waker>),
    /// Running, but the awaiting future was dropped.
    Cancelled,
    Ended(Result<T, JobLost>),
    ReplyLost(JobLost),
    /// Final: the result was delivered or is not wanted.
    Done,
}

impl<F, T> Job<F, T>
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static,
{
    pub(crate) fn new(work: F) -> Self {
        Self(Mutex::new(JobState::Queued(work, None)))
    }

    /// Neither work nor wakers run under the lock, so the data behind a poisoned lock
    /// is intact.
    fn lock(&self) -> MutexGuard<'_, JobState<F, T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn take_work(&self) -> Option<F> {
        let mut state = self.lock();
        match std::mem::replace(&mut *state, JobState::Done) {
            JobState::Queued(work, waker) => {
                *state = JobState::Running(waker);
                Some(work)
            }
            other => {
                *state = other;
                None
            }
        }
    }

    /// Stores the result and wakes the awaiting task; `false` when the job had been
    /// declared lost.
    fn complete(&self, result: Result<T, JobLost>) -> bool {
        let mut state = self.lock();
        match std::mem::replace(&mut *state, JobState::Done) {
            JobState::Running(waker) => {
                *state = JobState::Ended(result);
                drop(state);
                if let Some(waker) = waker {
                    waker.wake();
                }
                true
            }
            JobState::ReplyLost(reason) => {
                *state = JobState::ReplyLost(reason);
                drop(state);
                drop_caught(result);
                false
            }
            // Only a cancelled job is left: a worker completes each job once.
            _ => {
                drop(state);
                drop_caught(result);
                true
            }
        }
    }

    fn poll_result(&self, context: &Context<'_>) -> Poll<Result<T, JobLost>> {
        let mut state = self.lock();
        match &mut *state {
            JobState::Queued(_, waker) | JobState::Running(waker) => {
                *waker = Some(context.waker().clone());
                Poll::Pending
            }
            JobState::ReplyLost(reason) => Poll::Ready(Err(reason.clone())),
            JobState::Ended(_) => match std::mem::replace(&mut *state, JobState::Done) {
                JobState::Ended(result) => Poll::Ready(result),
                _ => Poll::Pending,
            },
            // A future is not polled after it was ready or dropped.
            JobState::Cancelled | JobState::Done => Poll::Pending,
        }
    }

    /// Cancels the job: drops work that has not begun and a result that was not
    /// fetched.
    fn cancel(&self) {
        let mut state = self.lock();
        let next = match &*state {
            JobState::Running(_) => JobState::Cancelled,
            JobState::Queued(..) | JobState::Ended(_) => JobState::Done,
            JobState::Cancelled | JobState::ReplyLost(_) | JobState::Done => return,
        };
        let previous = std::mem::replace(&mut *state, next);
        drop(state);
        drop_caught(previous);
    }
}

impl<F, T> Task for Job<F, T>
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static,
{
    fn run(&self, progress: &Progress) -> bool {
        match self.take_work() {
            Some(work) => self.complete(catch_panic(|| work(progress)).map_err(JobLost::Panicked)),
            None => true,
        }
    }

    fn mark_lost(&self, reason: JobLost) -> bool {
        let mut state = self.lock();
        if matches!(
            *state,
            JobState::Ended(_) | JobState::ReplyLost(_) | JobState::Done
        ) {
            return false;
        }
        let previous = std::mem::replace(&mut *state, JobState::ReplyLost(reason));
        drop(state);
        if let JobState::Queued(_, Some(waker)) | JobState::Running(Some(waker)) = &previous {
            waker.wake_by_ref();
        }
        drop_caught(previous);
        true
    }
}

/// Future of a job's result; dropping it cancels work that has not begun.
pub(crate) struct JobResult<F, T>(pub(crate) Arc<Job<F, T>>)
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static;

impl<F, T> Future for JobResult<F, T>
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static,
{
    type Output = Result<T, JobLost>;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        self.0.poll_result(context)
    }
}

impl<F, T> Drop for JobResult<F, T>
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static,
{
    fn drop(&mut self) {
        self.0.cancel();
    }
}
