//! Document of a task of the robot.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Running or ended task of the robot.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct TaskDocument {
    /// Number of the task.
    pub task_id: u64,
    /// Kind of the task.
    pub kind: String,
    /// Parameters of the task.
    pub parameters: String,
    /// Author of the task.
    pub author: String,
    /// State of the task: `running`, `succeeded`, `failed` or `cancelled`.
    pub state: String,
    /// Phase of the running task in one word; empty when its author names none.
    #[serde(default)]
    pub phase: String,
    /// Steps of the plan, in order; empty without a plan.
    #[serde(default)]
    pub plan: Vec<String>,
    /// Track-ids of the objects that the task handles.
    #[serde(default)]
    pub track_ids: Vec<u64>,
    /// Start time of the task, nanoseconds since 1970.
    pub started_ns: u64,
    /// End time; null while the task runs.
    pub ended_ns: Option<u64>,
    /// Reason for the outcome; empty when none was given.
    pub reason: String,
}

/// Page of tasks, newest first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TasksDocument {
    /// Running and ended tasks.
    pub tasks: Vec<TaskDocument>,
    /// Cursor of the next page; null after the last page.
    pub next: Option<u64>,
}
