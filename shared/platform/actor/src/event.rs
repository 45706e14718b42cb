//! Supervisor events: starts, restarts, stops and escalation.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use crate::mailbox::{DropOldest, Receiver};
use crate::worker_pool::JobLost;

/// Event stream of a supervisor, oldest first. Bounded: a slow reader loses the
/// oldest events, which [`dropped`](Receiver::dropped) counts. Ends after the
/// supervisor and all its actors are gone.
pub type Events<I> = Receiver<LifecycleEvent<I>, DropOldest>;

/// Life-cycle event of one actor, or of all.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum LifecycleEvent<I> {
    /// Actor is ready for messages, for the first time or after a restart.
    Started {
        /// Id of the started actor.
        id: I,
    },
    /// Actor failed and restarts after the back-off.
    Restarting {
        /// Id of the restarting actor.
        id: I,
        /// Cause of the actor's failure.
        cause: Cause,
        /// Tag of the message being handled, which is lost; `None` outside `handle`.
        tag: Option<u64>,
        /// Back-off delay before the restart.
        after: Duration,
    },
    /// Actor stopped and is not restarted.
    Stopped {
        /// Id of the stopped actor.
        id: I,
        /// Reason for the actor's stop.
        reason: StopReason,
    },
    /// Actor did not stop within the time limit and was abandoned.
    Abandoned {
        /// Id of the abandoned actor.
        id: I,
    },
    /// Restart intensity exceeded: all actors were stopped, and no more can be
    /// spawned. The last event.
    Escalated(Escalation<I>),
}

/// Escalation (OTP): a supervisor gave up after stopping all its actors.
#[derive(Debug, Clone)]
pub struct Escalation<I> {
    /// Id of the actor whose failure exceeded the limit.
    pub id: I,
    /// Cause of that failure.
    pub cause: Cause,
    /// Tag of the message being handled; `None` outside `handle`.
    pub tag: Option<u64>,
    /// Limit that was exceeded: restarts within `window`.
    pub max_restarts: u32,
    /// Length of the sliding window of restarts.
    pub window: Duration,
}

/// Cause of an actor's failure.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Cause {
    /// Panic of the actor with this message.
    Panicked(String),
    /// Error that the actor returned.
    Failed(Arc<dyn std::error::Error + Send + Sync>),
    /// Job lost by the worker pool: it stalled, or the pool is exhausted.
    ReplyLost(JobLost),
    /// A permanent actor stopped itself.
    Finished,
}

/// Reason of an actor's final stop.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum StopReason {
    /// Stop requested for this actor or for all.
    Requested,
    /// Actor stopped itself.
    Finished,
    /// The actor failed and is not restarted: by its restart type, because a stop was
    /// requested, or because the limit was exceeded.
    Failed {
        /// Cause of the actor's failure.
        cause: Cause,
        /// Tag of the message being handled; `None` outside `handle`.
        tag: Option<u64>,
    },
}

/// Log sentence of an event.
impl<I: fmt::Debug> fmt::Display for LifecycleEvent<I> {
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
                reason: StopReason::Requested,
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
                write!(f, "Actor {id:?} has stopped permanently, because ")?;
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
            Self::ReplyLost(lost) => write!(f, "its work was lost: {lost}"),
            Self::Finished => f.write_str("it ended by itself"),
        }
    }
}
