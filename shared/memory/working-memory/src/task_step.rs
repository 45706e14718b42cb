//! Steps of a task: what its author records of each, and the times of the memory.

use serde::{Deserialize, Serialize};

/// Maximum number of steps of a task. Chosen.
pub const MAX_TASK_STEPS: usize = 256;
/// Maximum length of a step's primitive, label and place, bytes: that of a category's name.
pub const MAX_STEP_WORD_BYTES: usize = 64;
/// Maximum length of a step's reason, bytes. Chosen.
pub const MAX_STEP_REASON_BYTES: usize = 512;
/// Maximum length of a step's plan, bytes. Chosen.
pub const MAX_PLAN_BYTES: usize = 8192;
/// Maximum length of the plans of all steps of a task together, bytes. Chosen: a task with the most
/// steps and the longest texts fits into a message of the control protocol.
pub const MAX_TASK_PLAN_BYTES: usize = 256 * 1024;
/// Bytes of a step without its texts; an estimate.
const STEP_BYTES: usize = 256;

/// State of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum StepState {
    /// Step is carried out; the gripper does not hold its object.
    Running,
    /// Step is carried out, and the object is in the gripper.
    Held,
    /// Step has ended with success.
    Succeeded,
    /// Step has ended without success.
    Failed,
}

/// Content of a step, as the author of its task records it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepContent {
    /// Number of the step, from 1 in its task.
    pub number: u64,
    /// State of the step.
    pub state: StepState,
    /// Primitive of the step, the present or the last one, 1 to 64 bytes.
    pub primitive: String,
    /// Track-id of the object that the step handles.
    pub track_id: u64,
    /// Label of the object, at most 64 bytes.
    pub label: Option<String>,
    /// Name of the place where the object is to go, at most 64 bytes.
    pub place: Option<String>,
    /// Number of the attempt, from 1 for each object.
    pub attempt: u32,
    /// Reason of a failure or a delay, for people, at most 512 bytes.
    pub reason: String,
    /// Grasp and placement in the syntax of the author, at most 8192 bytes.
    pub plan: String,
}

/// Step of a task with its times.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskStep {
    /// Content of the step, as it was recorded last.
    pub content: StepContent,
    /// Time of the step's first record, nanoseconds since 1970.
    pub started_ns: u64,
    /// End time, not before the start; `None` until the step has ended.
    pub ended_ns: Option<u64>,
}

/// Reason for refusing to record a step.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StepRefusal {
    /// Number that is neither that of the newest step nor the next one.
    #[error("task {task} has no step {number}; record its next step as number {next}")]
    Number {
        /// Number of the task.
        task: u64,
        /// Number of the step in the request.
        number: u64,
        /// Number of the next step.
        next: u64,
    },
    /// Refusal to begin a step while another one has not ended.
    #[error(
        "step {open} of task {task} has not ended; record its success or failure before the next \
         step"
    )]
    IsOpen {
        /// Number of the task.
        task: u64,
        /// Number of the step that has not ended.
        open: u64,
    },
    /// Refusal to change a step that has ended.
    #[error("step {number} of task {task} has ended and stays as it is; record another step")]
    HasEnded {
        /// Number of the task.
        task: u64,
        /// Number of the step that has ended.
        number: u64,
    },
    /// Refusal of a step above the limit of a task.
    #[error("task {task} has {MAX_TASK_STEPS} steps already; end it and go on in another task")]
    TooMany {
        /// Number of the task.
        task: u64,
    },
    /// Attempt zero.
    #[error("a step's attempt is 0; count the attempts from 1")]
    Attempt,
    /// Text of a step that is empty or above its length limit.
    #[error("{}", text_sentence(what, *n_bytes, *most))]
    Text {
        /// Name of the text: primitive, label, place, reason or plan.
        what: &'static str,
        /// Length of the text, bytes.
        n_bytes: usize,
        /// Maximum length of the text, bytes.
        most: usize,
    },
    /// Plans of a task that are too long together.
    #[error(
        "the plans of task {task} would have {n_bytes} bytes together, and {MAX_TASK_PLAN_BYTES} is \
         the most; record a shorter plan, or go on in another task"
    )]
    Plans {
        /// Number of the task.
        task: u64,
        /// Length of all plans of the task with the refused one, bytes.
        n_bytes: usize,
    },
    /// Steps of all running tasks that are too large together.
    #[error("the steps of all running tasks have {n_bytes} bytes; end tasks that do not go on")]
    Full {
        /// Size of the steps of all running tasks, bytes.
        n_bytes: usize,
    },
}

fn text_sentence(what: &str, n_bytes: usize, most: usize) -> String {
    match n_bytes {
        0 => format!("a step's {what} is empty; give one"),
        _ => format!("a step's {what} has {n_bytes} bytes; use at most {most}"),
    }
}

impl StepState {
    /// True if the step is over, with or without success.
    pub fn is_ended(self) -> bool {
        matches!(self, Self::Succeeded | Self::Failed)
    }
}

impl StepContent {
    pub(crate) fn check(&self) -> Result<(), StepRefusal> {
        if self.attempt == 0 {
            return Err(StepRefusal::Attempt);
        }
        let word = |text: &Option<String>| text.as_ref().map_or(0, String::len);
        if self.primitive.is_empty() {
            return Err(text_refusal("primitive", 0, MAX_STEP_WORD_BYTES));
        }
        for (what, n_bytes, most) in [
            ("primitive", self.primitive.len(), MAX_STEP_WORD_BYTES),
            ("label", word(&self.label), MAX_STEP_WORD_BYTES),
            ("place", word(&self.place), MAX_STEP_WORD_BYTES),
            ("reason", self.reason.len(), MAX_STEP_REASON_BYTES),
            ("plan", self.plan.len(), MAX_PLAN_BYTES),
        ] {
            if n_bytes > most {
                return Err(text_refusal(what, n_bytes, most));
            }
        }
        Ok(())
    }

    /// Size of the step in memory, bytes; an estimate.
    pub(crate) fn n_bytes(&self) -> usize {
        let word = |text: &Option<String>| text.as_ref().map_or(0, String::len);
        let words = self.primitive.len() + word(&self.label) + word(&self.place);
        STEP_BYTES + words + self.reason.len() + self.plan.len()
    }
}

fn text_refusal(what: &'static str, n_bytes: usize, most: usize) -> StepRefusal {
    StepRefusal::Text {
        what,
        n_bytes,
        most,
    }
}
