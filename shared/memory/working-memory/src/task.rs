//! Tasks of the robot, running and ended.

use durable_leveldb::MutationId;
use serde::{Deserialize, Serialize};

use crate::event::Outcome;
use crate::task_step::{StepRefusal, TaskStep};

/// Maximum length of a task kind, bytes.
const MAX_KIND_BYTES: usize = 64;
/// Maximum length of task parameters and of an end reason, bytes.
const MAX_TEXT_BYTES: usize = 2048;
/// Maximum length of an author name, bytes.
const MAX_AUTHOR_BYTES: usize = 256;

/// Request to start a task of the robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewTask {
    /// Idempotency key of the request.
    pub id: MutationId,
    /// Kind of the task, 1 to 64 bytes.
    pub kind: String,
    /// Parameters in the syntax of the requester, at most 2048 bytes.
    pub parameters: String,
    /// Author of the task, at most 256 bytes.
    pub author: String,
}

/// Request to end a task of the robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskEnd {
    /// Idempotency key of the request.
    pub id: MutationId,
    /// Number of the robot task that ends.
    pub task: u64,
    /// Outcome of the robot task.
    pub outcome: Outcome,
    /// Reason for the outcome, at most 2048 bytes.
    pub reason: String,
}

/// Running or ended task of the robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// Number of the task, from one.
    pub number: u64,
    /// Kind of the task.
    pub kind: String,
    /// Parameters of the task.
    pub parameters: String,
    /// Author of the task.
    pub author: String,
    /// Start time of the task, nanoseconds since 1970.
    pub started_ns: u64,
    /// State of the task.
    pub state: TaskState,
    pub(crate) start_id: u128,
    /// Steps of the task in order; each has its index plus one as its number.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<TaskStep>,
}

/// State of a task: running or ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum TaskState {
    /// Task is running.
    Running,
    /// Task has ended.
    Ended {
        /// Outcome of the ended task.
        outcome: Outcome,
        /// Reason for the task's outcome.
        reason: String,
        /// End time, nanoseconds since 1970, not before the start.
        ended_ns: u64,
        /// Idempotency key of the request that ended the task.
        end_id: u128,
    },
}

/// Reason for refusing to start or end a task, or to record a step.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskRefusal {
    /// Unknown task number.
    #[error(
        "there is no task {task}; it was never started, or ended so long ago that it is forgotten"
    )]
    Unknown {
        /// Task number in the request.
        task: u64,
    },
    /// Refusal to end a task, or to record a step of it, that has ended already.
    #[error("task {task} has ended already; start another one to do it again")]
    HasEnded {
        /// Number of the task that has ended.
        task: u64,
    },
    /// Task text that is empty or above its length limit.
    #[error("{}", text_sentence(what, *n_bytes, *most))]
    Text {
        /// Name of the text: kind, parameters, author or reason.
        what: &'static str,
        /// Length of the text, bytes.
        n_bytes: usize,
        /// Maximum length of the text, bytes.
        most: usize,
    },
    /// Refusal because too many tasks are running.
    #[error("{n_running} tasks run already; end some of them before starting another one")]
    TooMany {
        /// Number of running tasks.
        n_running: usize,
    },
    /// Refusal to record a step.
    #[error(transparent)]
    Step(#[from] StepRefusal),
}

fn text_sentence(what: &str, n_bytes: usize, most: usize) -> String {
    match n_bytes {
        0 => format!("a task's {what} is empty; give one"),
        _ => format!("a task's {what} has {n_bytes} bytes; use at most {most}"),
    }
}

impl NewTask {
    pub(crate) fn check(&self) -> Result<(), TaskRefusal> {
        if self.kind.is_empty() {
            return Err(too_long("kind", "", 0));
        }
        check("kind", &self.kind, MAX_KIND_BYTES)?;
        check("parameters", &self.parameters, MAX_TEXT_BYTES)?;
        check("author", &self.author, MAX_AUTHOR_BYTES)
    }
}

impl TaskEnd {
    pub(crate) fn check(&self) -> Result<(), TaskRefusal> {
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
