//! Documents of a task of the robot and of its steps.

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
    /// Steps of the task that were begun, in order: all in the answer about one task, the newest
    /// ones on a page of tasks.
    #[serde(default)]
    pub steps: Vec<TaskStepDocument>,
}

/// Step of a task: one attempt to handle one object.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct TaskStepDocument {
    /// Number of the step, from 1 in its task.
    pub number: u64,
    /// State of the step: `running`, `held` while the object is in the gripper, `succeeded` or
    /// `failed`.
    pub state: String,
    /// Primitive of the step, the present or the last one, such as `reach` or `lift`.
    pub primitive: String,
    /// Track-id of the object that the step handles.
    pub track_id: u64,
    /// Label of the object; null for none.
    pub label: Option<String>,
    /// Name of the place where the object is to go; null for none.
    pub place: Option<String>,
    /// Number of the attempt, from 1 for each object.
    pub attempt: u32,
    /// Reason of a failure or a delay, for people; empty while nothing went wrong.
    pub reason: String,
    /// Grasp and placement, as JSON of the task's author; empty on a page of tasks.
    pub plan: String,
    /// Start time of the step, nanoseconds since 1970.
    pub started_ns: u64,
    /// End time; null until the step has succeeded or failed.
    pub ended_ns: Option<u64>,
}

/// Page of tasks, newest first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct TasksDocument {
    /// Running and ended tasks.
    pub tasks: Vec<TaskDocument>,
    /// Cursor of the next page; null after the last page.
    pub next: Option<u64>,
}
