//! Tasks: what was to be done, and how it ended.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::event::Outcome;
use crate::mutation::MutationId;

/// Longest name of a kind of task, bytes.
const MAX_KIND_BYTES: usize = 64;
/// Longest parameters of a task, and longest reason for its end, bytes.
const MAX_TEXT_BYTES: usize = 2048;
/// Longest name of who starts a task, bytes.
const MAX_AUTHOR_BYTES: usize = 256;

/// A task that is about to begin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewTask {
    /// The same id again gets the first answer.
    pub id: MutationId,
    /// What kind of task, 1 to 64 bytes.
    pub kind: String,
    /// Its parameters as who starts it writes them, at most 2048 bytes.
    pub parameters: String,
    /// Who starts it, at most 256 bytes.
    pub author: String,
}

/// The end of a task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskEnd {
    /// The same id again gets the first answer.
    pub id: MutationId,
    /// The task's number.
    pub task: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Why, at most 2048 bytes.
    pub reason: String,
}

/// A task, running or ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// Counts the tasks from one.
    pub number: u64,
    /// What kind of task.
    pub kind: String,
    /// Its parameters.
    pub parameters: String,
    /// Who started it.
    pub author: String,
    /// When it began, nanoseconds since 1970.
    pub started_ns: u64,
    /// How it ended; `None` while it runs.
    pub state: TaskState,
    pub(super) start_id: u128,
}

/// Whether a task runs, or how it ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum TaskState {
    /// It was started and not ended.
    Running,
    /// It is over.
    Ended {
        /// How.
        outcome: Outcome,
        /// Why.
        reason: String,
        /// When, nanoseconds since 1970, never before it began.
        ended_ns: u64,
        /// Id of the request that ended it.
        end_id: u128,
    },
}

/// Why a task is not started or not ended.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum TaskRefusal {
    /// There is no such task.
    Unknown {
        /// The number asked for.
        task: u64,
    },
    /// The task has ended already.
    HasEnded {
        /// Its number.
        task: u64,
    },
    /// A text is too long, or a kind is empty.
    Text {
        /// Which text.
        what: &'static str,
        /// Its length, bytes.
        n_bytes: usize,
        /// The longest allowed, bytes.
        most: usize,
    },
    /// Too many tasks run at once.
    TooMany {
        /// How many run.
        n_running: usize,
    },
}

impl NewTask {
    pub(super) fn check(&self) -> Result<(), TaskRefusal> {
        if self.kind.is_empty() {
            return Err(too_long("kind", "", 0));
        }
        check("kind", &self.kind, MAX_KIND_BYTES)?;
        check("parameters", &self.parameters, MAX_TEXT_BYTES)?;
        check("author", &self.author, MAX_AUTHOR_BYTES)
    }
}

impl TaskEnd {
    pub(super) fn check(&self) -> Result<(), TaskRefusal> {
        check("reason", &self.reason, MAX_TEXT_BYTES)
    }
}

fn check(what: &'static str, text: &str, most: usize) -> Result<(), TaskRefusal> {
    if text.len() > most {
        return Err(too_long(what, text, most));
    }
    Ok(())
}

fn too_long(what: &'static str, text: &str, most: usize) -> TaskRefusal {
    TaskRefusal::Text {
        what,
        n_bytes: text.len(),
        most,
    }
}

impl fmt::Display for TaskRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { task } => write!(
                f,
                "there is no task {task}; it was never started, or ended so long ago that it is \
                 forgotten"
            ),
            Self::HasEnded { task } => write!(
                f,
                "task {task} has ended already; start another one to do it again"
            ),
            Self::Text {
                what, n_bytes: 0, ..
            } => write!(f, "a task's {what} is empty; say what it is"),
            Self::Text {
                what,
                n_bytes,
                most,
            } => write!(f, "a task's {what} has {n_bytes} bytes; use at most {most}"),
            Self::TooMany { n_running } => write!(
                f,
                "{n_running} tasks run already; end some of them before starting another one"
            ),
        }
    }
}

impl std::error::Error for TaskRefusal {}
