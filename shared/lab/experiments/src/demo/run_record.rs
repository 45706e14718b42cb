//! Record of a demonstration at one table, as it is kept in the output folder.

use super::recognition_score::ScorePoint;
use crate::arguments::DemoVariant;
use serde::{Deserialize, Serialize};

/// Kind of a demonstration at a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum DemoKind {
    /// Every object goes to the place of its category.
    ClearTable,
    /// One object is asked for.
    Fetch,
}

/// Settings of a run: a record of others is not of this demonstration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RunSettings {
    pub(super) kind: DemoKind,
    pub(super) version: String,
    pub(super) models: String,
    pub(super) variant: DemoVariant,
    pub(super) objects: Option<u32>,
}

/// Object other than the handled one that was moved by more than a centimetre, or tipped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Collision {
    pub(super) time_s: f64,
    pub(super) object: String,
    pub(super) category: String,
    /// Track that the robot handled.
    pub(super) handled: Option<u64>,
}

/// Outcome of one object, by truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ObjectOutcome {
    pub(super) category: String,
    pub(super) name: String,
    /// True for an object that the robot is to carry.
    pub(super) is_wanted: bool,
    /// Name of the place of its category.
    pub(super) place: String,
    pub(super) is_in_place: bool,
    pub(super) is_on_floor: bool,
    /// Middle at the end, world, metres, to a tenth of a millimetre.
    pub(super) position_m: Option<[f64; 3]>,
}

/// Event of a run, for the plot and the log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RunEvent {
    /// Time of the source since its first frame, seconds.
    pub(super) time_s: f64,
    pub(super) kind: EventKind,
    pub(super) sentence: String,
}

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum EventKind {
    Taught,
    Instructed,
    Grasped,
    Placed,
    Failed,
    TrackEnded,
    Ended,
}

/// Record of a run. Without measured durations: a repetition gives the same bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RunRecord {
    pub(super) settings: RunSettings,
    pub(super) seed: u64,
    /// Category that was asked for.
    pub(super) wanted: Option<String>,
    /// Sentence with which the robot has refused the order.
    pub(super) refusal: Option<String>,
    /// Number of objects that the robot was to carry.
    pub(super) n_objects: usize,
    pub(super) n_in_place: usize,
    pub(super) collisions: Vec<Collision>,
    pub(super) n_standard_moved: usize,
    /// Notes of the arm's motions that have failed, such as at a contact.
    pub(super) stops: Vec<String>,
    /// Time from the instruction to the end of the task, seconds of the source.
    pub(super) seconds: f64,
    pub(super) n_taught: usize,
    pub(super) n_corrected: usize,
    /// Phase in which the task ended; empty for a refused order.
    pub(super) phase: String,
    /// Report of the task in words.
    pub(super) sentence: String,
    pub(super) precision: Option<f64>,
    pub(super) recall: Option<f64>,
    pub(super) objects: Vec<ObjectOutcome>,
    pub(super) events: Vec<RunEvent>,
    pub(super) scores: Vec<ScorePoint>,
}
