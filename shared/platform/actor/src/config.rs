//! Supervisor configuration: restart type, restart policy, placement, mailbox
//! capacity.

use std::num::NonZeroUsize;
use std::time::Duration;

use crate::restart_policy::RestartPolicy;
use crate::worker_pool::WorkerPool;

/// Restart type of an actor (OTP): the kinds of exit after which it is restarted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Restart {
    /// Restart after every exit, unless a stop was requested.
    Permanent,
    /// Restart after a failure, not after the actor stops itself.
    Transient,
    /// Restart type: never restart.
    Temporary,
}

/// Placement of handlers: on the reactor's threads or on a worker pool.
#[derive(Debug, Clone)]
pub enum Placement {
    /// Inline, in the actor's own task: for handlers of microseconds. A handler that
    /// hangs there keeps the thread for ever.
    Inline,
    /// Handlers run on a worker pool, whose watchdog abandons a handler that hangs.
    Pool(WorkerPool),
}

/// Settings of a supervisor, common to all its actors.
#[derive(Debug, Clone)]
pub struct Config {
    /// Exits after which an actor is restarted.
    pub restart: Restart,
    /// Restart intensity and back-off: the limit counts the restarts of all actors
    /// together, the back-off those of the one actor.
    pub policy: RestartPolicy,
    /// Placement of handlers: worker pool or actor task.
    pub placement: Placement,
    /// Mailbox capacity of one actor, messages.
    pub mailbox_capacity: NonZeroUsize,
    /// Time limit of an orderly stop: for the message being handled and `stop`.
    pub shutdown: Duration,
    /// Capacity of the event queue; a slow reader loses older events.
    pub event_capacity: NonZeroUsize,
}
