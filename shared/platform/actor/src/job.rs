//! One job of the worker pool: the work, and the meeting point of the worker,
//! the one who awaits it, and the watchdog who may declare it lost.

use std::fmt;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

use crate::border::{discard, guarded};
use crate::progress::Progress;
use crate::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Why a job has no result.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum JobLost {
    /// It panicked with this message.
    Panicked(String),
    /// It showed no progress for the stall time; its thread was left behind,
    /// and holds what the job borrowed until it moves again.
    Stalled,
    /// The pool has lost too many workers and takes no more work.
    Exhausted,
}

impl fmt::Display for JobLost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Panicked(message) => write!(
                f,
                "The job panicked ({message}); its result is lost, and the panic is a bug to fix."
            ),
            Self::Stalled => f.write_str(
                "The job showed no progress for the stall time and was abandoned with its \
                 thread; shorten it or let it tick.",
            ),
            Self::Exhausted => f.write_str(
                "The job was not run, because too many workers of the pool have stalled; \
                 end the process and let its supervisor start it again.",
            ),
        }
    }
}

impl std::error::Error for JobLost {}

/// A job as the pool sees it, whatever its result.
pub(crate) trait Task: Send + Sync {
    /// Runs the work on this thread. False when it was declared lost meanwhile,
    /// so that this thread has been replaced.
    fn run(&self, progress: &Progress) -> bool;

    /// Declares the job lost. False when it had already ended.
    fn lose(&self, reason: JobLost) -> bool;
}

pub(crate) struct Job<F, T>(Mutex<State<F, T>>);

enum State<F, T> {
    Queued(F, Option<Waker>),
    Running(Option<Waker>),
    /// Running, and nobody awaits it any more.
    Unwanted,
    Ended(Result<T, JobLost>),
    Lost(JobLost),
    /// Nothing is left to do: the result was handed out or nobody wanted it.
    Over,
}

impl<F, T> Job<F, T>
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static,
{
    pub(crate) fn new(work: F) -> Self {
        Self(Mutex::new(State::Queued(work, None)))
    }

    /// Neither work nor wakers run under the lock, so a poisoned one is whole.
    fn lock(&self) -> MutexGuard<'_, State<F, T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn take_work(&self) -> Option<F> {
        let mut state = self.lock();
        match std::mem::replace(&mut *state, State::Over) {
            State::Queued(work, waker) => {
                *state = State::Running(waker);
                Some(work)
            }
            other => {
                *state = other;
                None
            }
        }
    }

    /// Hands over the result; false when the job had been declared lost.
    fn settle(&self, result: Result<T, JobLost>) -> bool {
        let mut state = self.lock();
        match std::mem::replace(&mut *state, State::Over) {
            State::Running(waker) => {
                *state = State::Ended(result);
                drop(state);
                if let Some(waker) = waker {
                    waker.wake();
                }
                true
            }
            State::Lost(reason) => {
                *state = State::Lost(reason);
                drop(state);
                discard(result);
                false
            }
            // Only an unwanted job is left: a worker settles what it runs, once.
            _ => {
                drop(state);
                discard(result);
                true
            }
        }
    }

    fn poll_result(&self, context: &Context<'_>) -> Poll<Result<T, JobLost>> {
        let mut state = self.lock();
        match &mut *state {
            State::Queued(_, waker) | State::Running(waker) => {
                *waker = Some(context.waker().clone());
                Poll::Pending
            }
            State::Lost(reason) => Poll::Ready(Err(reason.clone())),
            State::Ended(_) => match std::mem::replace(&mut *state, State::Over) {
                State::Ended(result) => Poll::Ready(result),
                _ => Poll::Pending,
            },
            // A future is not polled after it was ready or dropped.
            State::Unwanted | State::Over => Poll::Pending,
        }
    }

    /// Nobody awaits it any more: work not yet begun and results not yet
    /// fetched are dropped here.
    fn cancel(&self) {
        let mut state = self.lock();
        let next = match &*state {
            State::Running(_) => State::Unwanted,
            State::Queued(..) | State::Ended(_) => State::Over,
            State::Unwanted | State::Lost(_) | State::Over => return,
        };
        let previous = std::mem::replace(&mut *state, next);
        drop(state);
        discard(previous);
    }
}

impl<F, T> Task for Job<F, T>
where
    F: FnOnce(&Progress) -> T + Send + 'static,
    T: Send + 'static,
{
    fn run(&self, progress: &Progress) -> bool {
        match self.take_work() {
            Some(work) => self.settle(guarded(|| work(progress)).map_err(JobLost::Panicked)),
            None => true,
        }
    }

    fn lose(&self, reason: JobLost) -> bool {
        let mut state = self.lock();
        if matches!(*state, State::Ended(_) | State::Lost(_) | State::Over) {
            return false;
        }
        let previous = std::mem::replace(&mut *state, State::Lost(reason));
        drop(state);
        if let State::Queued(_, Some(waker)) | State::Running(Some(waker)) = &previous {
            waker.wake_by_ref();
        }
        discard(previous);
        true
    }
}

/// The awaiting end of a job; dropping it cancels work that has not begun.
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
