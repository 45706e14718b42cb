//! How a supervisor treats its actors.

use std::num::NonZeroUsize;
use std::time::Duration;

use crate::restart_policy::RestartPolicy;
use crate::worker_pool::WorkerPool;

/// Which ends of an actor call for a restart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Restart {
    /// Every end, unless it was told to stop.
    Permanent,
    /// A failure; not its own wish to stop.
    Transient,
    /// None.
    Temporary,
}

/// Where handlers run.
#[derive(Debug, Clone)]
pub enum Placement {
    /// In the actor's own task, on the reactor's threads: for handlers of
    /// microseconds. A handler that hangs there keeps the thread for ever.
    Inline,
    /// On a worker pool, whose watchdog abandons one that hangs.
    Pool(WorkerPool),
}

/// What holds for all actors of one supervisor.
#[derive(Debug, Clone)]
pub struct Config {
    /// When an actor is restarted.
    pub restart: Restart,
    /// How often: the limit counts the restarts of all actors together, the
    /// back-off those of the one actor.
    pub policy: RestartPolicy,
    /// Where handlers run.
    pub placement: Placement,
    /// Messages that wait for one actor.
    pub mailbox_capacity: NonZeroUsize,
    /// Time for the message at work and `stop` to finish, once told to stop.
    pub shutdown: Duration,
    /// Events kept for a slow reader.
    pub event_capacity: NonZeroUsize,
}
