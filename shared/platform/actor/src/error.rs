//! What can go wrong before an actor or a pool runs.

use std::fmt;
use std::io;

/// Why a pool, a policy or an actor could not be set up.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The operating system gave no thread.
    ThreadNotStarted {
        /// The thread's name.
        name: String,
        /// What the system answered.
        source: io::Error,
    },
    /// The restart policy contradicts itself.
    InvalidRestartPolicy {
        /// Which rule it breaks.
        rule: &'static str,
    },
    /// An actor with this id lives, or is still stopping.
    AlreadyRunning {
        /// The id, as its `Debug` writes it.
        id: String,
    },
    /// The supervisor has escalated or was told to stop everything.
    SupervisorEnded {
        /// The id that was to be spawned.
        id: String,
    },
    /// Two children of a tree have the same id.
    DuplicateChild {
        /// The id.
        id: &'static str,
    },
    /// A life that was left behind has not ended, and there must not be two.
    StillAtWork,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ThreadNotStarted { name, source } => write!(
                f,
                "The worker thread {name} could not be started ({source}); \
                 allow the process more threads or configure fewer workers."
            ),
            Self::InvalidRestartPolicy { rule } => {
                write!(
                    f,
                    "The restart policy is refused: {rule}; correct the configuration."
                )
            }
            Self::AlreadyRunning { id } => write!(
                f,
                "The actor {id} was not spawned, because one with this id is alive or still \
                 stopping; await its stop or use a new id."
            ),
            Self::SupervisorEnded { id } => write!(
                f,
                "The actor {id} was not spawned, because its supervisor has ended; \
                 look for the escalation among its events and start a new supervisor."
            ),
            Self::DuplicateChild { id } => write!(
                f,
                "The tree was not built, because two of its children are called {id}; \
                 give each its own name."
            ),
            Self::StillAtWork => f.write_str(
                "The actor was not started again, because its previous life hangs and was left \
                 behind; restart the process.",
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::ThreadNotStarted { source, .. } => Some(source),
            _ => None,
        }
    }
}
