//! Errors of setting up a pool, a restart policy or an actor.

use std::io;

use thiserror::Error;

/// Error of setting up a pool, restart policy or actor.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// Thread that the operating system refused to create.
    #[error(
        "The worker thread {name} could not be started ({source}); allow the process \
         more threads or configure fewer workers."
    )]
    ThreadNotStarted {
        /// Name of the thread that could not be started.
        name: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Contradictory restart policy.
    #[error("The restart policy is refused: {rule}; correct the configuration.")]
    InvalidRestartPolicy {
        /// Rule that the restart policy violates.
        rule: &'static str,
    },
    /// Repeated id: an actor with this id is running or still stopping.
    #[error(
        "The actor {id} was not spawned, because one with this id is alive or still \
         stopping; await its stop or use a new id."
    )]
    AlreadyRunning {
        /// Id of that actor, in `Debug` format.
        id: String,
    },
    /// Spawn refused, because the supervisor has escalated or has stopped all actors.
    #[error(
        "The actor {id} was not spawned, because its supervisor has ended; look for \
         the escalation among its events and start a new supervisor."
    )]
    SupervisorEnded {
        /// Id of the actor that was to be spawned, in `Debug` format.
        id: String,
    },
}
