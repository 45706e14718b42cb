//! Events: what happened at an instant.

use serde::{Deserialize, Serialize};

/// Something that happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Grows by one from event to event, from one; a start of the memory leaves a gap.
    pub sequence: u64,
    /// When it was noticed, nanoseconds since 1970.
    pub wall_ns: u64,
    /// What happened.
    pub happening: Happening,
}

/// What can happen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Happening {
    /// The memory started; what it knew of objects and robot ended when they were
    /// last seen.
    Started,
    /// An object was seen that was not known.
    Appeared {
        /// The track.
        track_id: u64,
        /// What it was called then.
        label: Option<String>,
        /// Centre of its box in the world, metres.
        position_m: [f64; 3],
    },
    /// An object is given up: it has gone, or was not seen for too long.
    Vanished {
        /// The track.
        track_id: u64,
        /// What it was called then.
        label: Option<String>,
    },
    /// An object is called otherwise.
    Relabelled {
        /// The track.
        track_id: u64,
        /// What it was called.
        before: Option<String>,
        /// What it is called now.
        after: Option<String>,
    },
    /// An object left a place where it had rested.
    Moved {
        /// The track.
        track_id: u64,
        /// Centre of its box at rest, world, metres.
        from_m: [f64; 3],
        /// Where it was noticed next.
        to_m: [f64; 3],
    },
    /// Somebody taught, corrected or forgot.
    Learned(Learned),
    /// The robot ended an action.
    ActionEnded {
        /// The robot's number of the command.
        command_id: u64,
        /// How it ended.
        outcome: Outcome,
        /// Why, empty when it succeeded.
        note: String,
    },
    /// A task began.
    TaskStarted {
        /// Its number.
        task: u64,
        /// What kind of task.
        kind: String,
    },
    /// A task ended.
    TaskEnded {
        /// Its number.
        task: u64,
        /// What kind of task.
        kind: String,
        /// How it ended.
        outcome: Outcome,
        /// Why.
        reason: String,
    },
}

/// A change of what was learned.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Learned {
    /// What was done.
    pub lesson: Lesson,
    /// The category.
    pub category: String,
    /// The track, unless a whole category was forgotten.
    pub track_id: Option<u64>,
    /// Who did it.
    pub author: String,
    /// Sequence in the history of the perceptual memory.
    pub history: u64,
}

/// What a person did to what was learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Lesson {
    /// Named an object.
    Taught,
    /// Named it otherwise.
    Corrected,
    /// Had a category forgotten.
    Forgot,
}

/// How an action or a task ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// As it should.
    Succeeded,
    /// It could not be done.
    Failed,
    /// Somebody ended it.
    Cancelled,
}
