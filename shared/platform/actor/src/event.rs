//! What a supervisor reports.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use crate::mailbox::{KeepLatest, Receiver};
use crate::worker_pool::JobLost;

/// The reports of a supervisor, oldest first. Bounded: a reader too slow loses
/// the oldest, which [`dropped`](Receiver::dropped) counts. Ends after the
/// supervisor and all its actors are gone.
pub type Events<I> = Receiver<Event<I>, KeepLatest>;

/// One thing that happened to an actor, or to all.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Event<I> {
    /// It is ready for messages, for the first time or again.
    Started {
        /// Which actor.
        id: I,
    },
    /// Its life ended and another begins after the back-off.
    Restarting {
        /// Which actor.
        id: I,
        /// Why its life ended.
        cause: Cause,
        /// The tag of the message at work, which is lost; `None` outside `handle`.
        tag: Option<u64>,
        /// The back-off.
        after: Duration,
    },
    /// It ended and does not come back.
    Stopped {
        /// Which actor.
        id: I,
        /// Why.
        reason: StopReason,
    },
    /// It did not stop within the shutdown time and was left behind.
    Abandoned {
        /// Which actor.
        id: I,
    },
    /// Restarts exceeded the policy: all actors were stopped, and no more can
    /// be spawned. The last event, unless a supervisor above begins anew.
    Escalated(Escalation<I>),
}

/// A supervisor gave up, after it had stopped all its actors.
#[derive(Debug, Clone)]
pub struct Escalation<I> {
    /// Whose failure was one too many.
    pub id: I,
    /// What that failure was.
    pub cause: Cause,
    /// The tag of the message at work; `None` outside `handle`.
    pub tag: Option<u64>,
    /// The limit that was exceeded.
    pub max_restarts: u32,
    /// Within which time.
    pub window: Duration,
}

/// Why an actor's life ended.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Cause {
    /// It panicked with this message.
    Panicked(String),
    /// It returned this error.
    Failed(Arc<dyn std::error::Error + Send + Sync>),
    /// The worker pool lost it: stalled, or the pool is exhausted.
    Lost(JobLost),
    /// It ended by itself, but is one that always runs.
    Finished,
}

/// Why an actor does not come back.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum StopReason {
    /// It was told to stop, or all were.
    Asked,
    /// It ended by itself.
    Finished,
    /// It failed, and is not one that is restarted, or was stopping, or
    /// exceeded the policy.
    Failed {
        /// Why.
        cause: Cause,
        /// The tag of the message at work; `None` outside `handle`.
        tag: Option<u64>,
    },
}

/// One sentence for the owner's log.
impl<I: fmt::Debug> fmt::Display for Event<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Started { id } => write!(f, "Actor {id:?} has started."),
            Self::Restarting {
                id,
                cause,
                tag,
                after,
            } => {
                write!(
                    f,
                    "Actor {id:?} starts again after {} ms, because ",
                    after.as_millis()
                )?;
                write_failure(f, cause, *tag)
            }
            Self::Stopped {
                id,
                reason: StopReason::Asked,
            } => {
                write!(f, "Actor {id:?} has stopped, as it was told.")
            }
            Self::Stopped {
                id,
                reason: StopReason::Finished,
            } => {
                write!(f, "Actor {id:?} has stopped by itself.")
            }
            Self::Stopped {
                id,
                reason: StopReason::Failed { cause, tag },
            } => {
                write!(f, "Actor {id:?} has stopped for good, because ")?;
                write_failure(f, cause, *tag)
            }
            Self::Abandoned { id } => {
                write!(
                    f,
                    "Actor {id:?} did not stop within the shutdown time and was left behind."
                )
            }
            Self::Escalated(escalation) => escalation.fmt(f),
        }
    }
}

impl<I: fmt::Debug> fmt::Display for Escalation<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "All actors were stopped, because more than {} restarts within {} s were needed, \
             the last by actor {:?}: ",
            self.max_restarts,
            self.window.as_secs_f64(),
            self.id
        )?;
        write_failure(f, &self.cause, self.tag)
    }
}

impl<I: fmt::Debug> std::error::Error for Escalation<I> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.cause {
            Cause::Failed(error) => Some(error.as_ref()),
            _ => None,
        }
    }
}

fn write_failure(f: &mut fmt::Formatter<'_>, cause: &Cause, tag: Option<u64>) -> fmt::Result {
    // An error may be a sentence of its own.
    let cause = cause.to_string();
    let cause = cause.trim_end_matches('.');
    match tag {
        Some(tag) => write!(f, "{cause} (at message {tag}, which is lost)."),
        None => write!(f, "{cause}."),
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Panicked(message) => write!(f, "it panicked: {message}"),
            Self::Failed(error) => write!(f, "it failed: {error}"),
            Self::Lost(lost) => write!(f, "its work was lost: {lost}"),
            Self::Finished => f.write_str("it ended by itself"),
        }
    }
}
