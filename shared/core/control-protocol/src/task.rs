//! Tasks of the robot: requests to the executive, and the report of a task.

use crate::learning::MutationId;
use serde::{Deserialize, Serialize};

/// Command about the tasks of the robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskCommand {
    /// Report the running task, or the last one.
    State,
    /// Tell what a task would do with the table as it is, without doing it.
    Preview(TaskOrder),
    /// Start a task.
    Start {
        /// Idempotency key: a repeated id gets the report of the task that it started.
        id: MutationId,
        /// Author of the task.
        author: String,
        /// Order of the task.
        order: TaskOrder,
    },
    /// Let the arm rest, and the task wait.
    Pause {
        /// Number of the running task.
        task_id: u64,
    },
    /// Let a task go on that was paused, or whose arm was stopped.
    Resume {
        /// Number of the running task.
        task_id: u64,
    },
    /// Cancel a task: it sets down what the hand holds, and ends.
    Cancel {
        /// Number of the running task.
        task_id: u64,
    },
}

/// Order of a task: what is to be done.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskOrder {
    /// Kind of the task.
    pub kind: TaskKind,
    /// Category of the object to fetch.
    #[serde(default)]
    pub category: Option<String>,
    /// Track-id of the object to fetch, in place of a category.
    #[serde(default)]
    pub track_id: Option<u64>,
    /// Name of the place to which an object is fetched; the hand-over place without one.
    #[serde(default)]
    pub place: Option<String>,
}

/// Kind of a task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskKind {
    /// Carry every object to the place of its category.
    #[default]
    ClearTable,
    /// Carry one object to a place.
    Fetch,
}

impl TaskKind {
    /// Name of the kind as one word.
    pub fn word(self) -> &'static str {
        match self {
            Self::ClearTable => "clear_table",
            Self::Fetch => "fetch",
        }
    }
}

/// Report of a task.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskReport {
    /// Number of the task; null for a preview, and before the first task.
    pub task_id: Option<u64>,
    /// Kind of the task; empty before the first one.
    pub kind: String,
    /// Author of the task.
    pub author: String,
    /// Phase of the task in one word, as in its graph; empty before the first one.
    pub phase: String,
    /// True if a person has paused the task.
    pub is_paused: bool,
    /// Cause of a wait, in words; empty while the task goes on.
    pub waits_for: String,
    /// Track-id of the object of the present step.
    pub track_id: Option<u64>,
    /// Label of that object.
    pub label: Option<String>,
    /// Name of the place to which it is carried.
    pub place: Option<String>,
    /// Number of the attempt for that object, from one; 0 without a step.
    pub attempt: u32,
    /// Number of objects that were carried to their places.
    pub n_done: u32,
    /// Report in words; of a running task what it does, of an ended one what was done, and why not
    /// more.
    pub sentence: String,
    /// Objects that come next, in their order, as the newest scene shows them.
    pub planned: Vec<PlannedObjectReport>,
    /// Objects that are left where they are.
    pub left: Vec<LeftObjectReport>,
}

/// Object that a task will carry.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedObjectReport {
    /// Track-id of the object.
    pub track_id: u64,
    /// Label of the object; null where it counts as unknown.
    pub label: Option<String>,
    /// Name of its goal place.
    pub place: String,
}

/// Object that a task leaves where it is.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftObjectReport {
    /// Track-id of the object.
    pub track_id: u64,
    /// Reason as a sentence.
    pub reason: String,
}
