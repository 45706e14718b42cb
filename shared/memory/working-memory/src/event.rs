//! Events of the world model: instantaneous occurrences with a sequence number.

use serde::{Deserialize, Serialize};

use crate::task_step::StepState;

/// Event with its sequence number and time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Sequence number, from one, without gaps except at a start of the memory.
    pub sequence: u64,
    /// Time at which the event was detected, nanoseconds since 1970.
    pub wall_ns: u64,
    /// Kind and details of the event.
    #[serde(rename = "happening")]
    pub kind: EventKind,
}

/// Kinds of events in the world model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum EventKind {
    /// Start of the memory. Facts about objects and the robot ended when these were last observed.
    Started,
    /// Object observed for the first time.
    Appeared {
        /// Track-id of the object.
        track_id: u64,
        /// Label of the object when it appeared.
        label: Option<String>,
        /// True if the label is only probable.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_probable: bool,
        /// Centre of the bounding box in the world frame, metres.
        position_m: [f64; 3],
    },
    /// Disappearance of an object: it has left, or was not seen for too long.
    Vanished {
        /// Track-id of the object.
        track_id: u64,
        /// Label of the object when it vanished.
        label: Option<String>,
        /// True if the label is only probable.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_probable: bool,
    },
    /// Change of the label of an object.
    Relabelled {
        /// Track-id of the object.
        track_id: u64,
        /// Label of the object before the change.
        before: Option<String>,
        /// Label of the object after the change.
        after: Option<String>,
        /// True if the label before the change was only probable.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        before_is_probable: bool,
        /// True if the label after the change is only probable.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        after_is_probable: bool,
    },
    /// Departure of an object from a place where it had rested.
    Moved {
        /// Track-id of the object.
        track_id: u64,
        /// Centre of the bounding box at rest, world frame, metres.
        from_m: [f64; 3],
        /// Centre of the bounding box at the next detection, world frame, metres.
        to_m: [f64; 3],
    },
    /// Question to a person about an object whose name would teach most.
    Question {
        /// Track-id of the object.
        track_id: u64,
        /// Most probable category, if any.
        category: Option<String>,
        /// The question as a sentence.
        sentence: String,
    },
    /// Teaching event: a label was taught, corrected or forgotten.
    /// Lesson: a label was taught, corrected or forgotten.
    #[serde(rename = "TeachingEvent")]
    Lesson(Lesson),
    /// End of an action of the robot arm.
    ActionEnded {
        /// Number of the robot command that ended.
        command_id: u64,
        /// Outcome of the robot action.
        outcome: Outcome,
        /// Reason of a failure; empty on success.
        note: String,
    },
    /// Start of a task of the robot.
    TaskStarted {
        /// Number of the started task.
        task: u64,
        /// Kind of the started task.
        kind: String,
    },
    /// End of a task of the robot.
    TaskEnded {
        /// Number of the ended task.
        task: u64,
        /// Kind of the ended task.
        kind: String,
        /// Outcome of the task.
        outcome: Outcome,
        /// Reason for the task's outcome.
        reason: String,
    },
    /// Change of the state of a task's step, or its first state.
    TaskStep(StepChange),
}

/// Change of the state of a step of a task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepChange {
    /// Number of the task.
    pub task: u64,
    /// Kind of the task.
    pub kind: String,
    /// Number of the step in its task.
    pub step: u64,
    /// Track-id of the object that the step handles.
    pub track_id: u64,
    /// State of the step after the change.
    pub state: StepState,
    /// Primitive of the step.
    pub primitive: String,
    /// Reason of a failure or a delay; may be empty.
    pub reason: String,
}

/// Lesson of a person: the label of an object or a category changed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lesson {
    /// Kind of the lesson.
    #[serde(rename = "lesson")]
    pub kind: LessonKind,
    /// Category that was taught, corrected or forgotten.
    pub category: String,
    /// Track-id; `None` if a whole category was forgotten.
    pub track_id: Option<u64>,
    /// Author of the teaching.
    pub author: String,
    /// Sequence number in the history of the perceptual memory.
    pub history: u64,
}

/// Kinds of lessons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LessonKind {
    /// Label taught to an object.
    Taught,
    /// Label of an object corrected.
    Corrected,
    /// Category forgotten.
    Forgot,
}

/// Result of an action or a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// Action or task succeeded.
    Succeeded,
    /// Action or task failed.
    Failed,
    /// Action or task was cancelled.
    Cancelled,
}
