//! Working memory: current and past world facts, events and tasks. Times are wall clock,
//! nanoseconds since 1970.

use crate::learning::MutationId;
use scene_document::{EventsDocument, FactsDocument, TaskDocument, TasksDocument, WorldDocument};
use serde::{Deserialize, Serialize};

/// Maximum waiting time of [`WorldCommand::Events`] (long polling), milliseconds.
pub const MAX_EVENT_WAIT_MS: u64 = 30_000;

/// Maximum number of facts per page.
pub const MAX_PAGE_FACTS: usize = 500;

/// Maximum number of events per answer.
pub const MAX_PAGE_EVENTS: usize = 96;

/// Maximum number of tasks per page.
pub const MAX_PAGE_TASKS: usize = 24;

/// Maximum number of steps of a task on a page of tasks: the newest ones, without their plans.
pub const MAX_PAGE_STEPS: usize = 16;

/// Maximum number of steps of a task.
pub const MAX_TASK_STEPS: usize = 256;

/// Maximum length of a step's primitive, label and place, bytes.
pub const MAX_STEP_WORD_BYTES: usize = 64;

/// Maximum length of a step's reason, bytes.
pub const MAX_STEP_REASON_BYTES: usize = 512;

/// Maximum length of a step's plan, bytes.
pub const MAX_PLAN_BYTES: usize = 8192;

/// Maximum length of the plans of all steps of a task together, bytes, so that the answer about
/// one task fits into a message.
pub const MAX_TASK_PLAN_BYTES: usize = 256 * 1024;

/// Query or update of the working memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldCommand {
    /// Report the present objects and the robot, with the start times of their facts.
    Now,
    /// Read one page of facts, newest first.
    Facts(FactFilter),
    /// Read the events after a sequence, oldest first (long polling). Answered at once when there
    /// are any, otherwise with the next event, or with none after the waiting time.
    Events {
        /// Sequence of the last known event; 0 for all.
        since: u64,
        /// Maximum waiting time, milliseconds, at most [`MAX_EVENT_WAIT_MS`]; 0 for none.
        wait_ms: u64,
    },
    /// Read one page of tasks, newest first.
    Tasks {
        /// Upper bound of the task id, exclusive: the `next` of the previous page.
        before: Option<u64>,
        /// Maximum number of tasks, up to [`MAX_PAGE_TASKS`].
        limit: u32,
    },
    /// Read one task with all its steps and their plans.
    Task {
        /// Number of the task to read.
        task_id: u64,
    },
    /// Record the start of a task.
    StartTask {
        /// Idempotency key: a repeated id gets the answer of the first request.
        id: MutationId,
        /// Kind of the task as one word.
        kind: String,
        /// Parameters, in a format of the author's choice.
        parameters: String,
        /// Author of the task.
        author: String,
    },
    /// Record the end of a task.
    EndTask {
        /// Idempotency key: a repeated id gets the answer of the first request.
        id: MutationId,
        /// Number of the task to end.
        task_id: u64,
        /// Outcome of the ended task.
        outcome: TaskOutcome,
        /// Reason, for people; may be empty after success.
        reason: String,
    },
    /// Record a step of a running task, or another content of its newest step. The same content
    /// again changes nothing.
    RecordStep {
        /// Number of the task that the step belongs to.
        task_id: u64,
        /// Content of the step.
        step: RecordedStep,
    },
}

/// Step of a task, as its author records it; the memory adds the times.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct RecordedStep {
    /// Number of the step: that of the newest step of its task, or the next one, from 1.
    pub number: u64,
    /// State of the step: `running`, `held` while the object is in the gripper, `succeeded` or
    /// `failed`. The last two end it.
    pub state: String,
    /// Primitive of the step, the present or the last one, up to [`MAX_STEP_WORD_BYTES`].
    pub primitive: String,
    /// Track-id of the object that the step handles.
    pub track_id: u64,
    /// Label of the object, up to [`MAX_STEP_WORD_BYTES`].
    #[serde(default)]
    pub label: Option<String>,
    /// Name of the place where the object is to go, up to [`MAX_STEP_WORD_BYTES`].
    #[serde(default)]
    pub place: Option<String>,
    /// Number of the attempt, from 1 for each object.
    pub attempt: u32,
    /// Reason of a failure or a delay, for people, up to [`MAX_STEP_REASON_BYTES`].
    #[serde(default)]
    pub reason: String,
    /// Grasp and placement, as JSON of the author on one line, up to [`MAX_PLAN_BYTES`].
    #[serde(default)]
    pub plan: String,
}

/// Filter of facts: those that held at an instant at which all conditions were true.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FactFilter {
    /// Track-id of the object that the fact describes.
    pub track_id: Option<u64>,
    /// Label of the object at that instant.
    pub label: Option<String>,
    /// Region that contained the centre of the object at that instant.
    pub region: Option<WorldRegion>,
    /// Earliest instant of the facts, nanoseconds since 1970.
    pub since_ns: Option<u64>,
    /// Latest instant of the facts, nanoseconds since 1970.
    pub until_ns: Option<u64>,
    /// Upper bound of the fact number, exclusive: the `next` of the previous page.
    pub before: Option<u64>,
    /// Maximum number of facts, up to [`MAX_PAGE_FACTS`].
    pub limit: u32,
}

impl Default for FactFilter {
    /// Filter for the first page of all facts.
    fn default() -> Self {
        Self {
            track_id: None,
            label: None,
            region: None,
            since_ns: None,
            until_ns: None,
            before: None,
            limit: MAX_PAGE_FACTS as u32,
        }
    }
}

/// Region in the world frame, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldRegion {
    /// Ball around a point.
    Ball {
        /// Centre of the ball.
        centre_m: [f64; 3],
        /// Radius of the ball, at least 0.
        radius_m: f64,
    },
    /// Axis-aligned box.
    Box {
        /// Minimum corner of the box.
        min_m: [f64; 3],
        /// Maximum corner of the box.
        max_m: [f64; 3],
    },
}

/// Outcome of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskOutcome {
    /// Task completed successfully.
    Succeeded,
    /// Task failed.
    Failed,
    /// Task cancelled by a person or program.
    Cancelled,
}

/// Reply to a [`WorldCommand`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WorldReply {
    /// Reply to [`WorldCommand::Now`].
    Now(Box<WorldDocument>),
    /// Reply to [`WorldCommand::Facts`].
    Facts(FactsDocument),
    /// Reply to [`WorldCommand::Events`].
    Events(EventsDocument),
    /// Reply to [`WorldCommand::Tasks`].
    Tasks(TasksDocument),
    /// Reply to [`WorldCommand::Task`]; and, with the steps of a page, to the start and end of a
    /// task and the record of a step: the record is on disk.
    Task(Box<TaskDocument>),
}
