//! The working memory: what is and was known of the world, what happened, and
//! which tasks were done. Times are the wall clock's, nanoseconds since 1970.

use super::learning::MutationId;
use serde::{Deserialize, Serialize};

/// Longest time that [`WorldCommand::Events`] waits for news, milliseconds.
pub const MAX_EVENT_WAIT_MS: u64 = 30_000;

/// Most facts of a page.
pub const MAX_PAGE_FACTS: usize = 500;

/// Most events of an answer.
pub const MAX_PAGE_EVENTS: usize = 128;

/// Most tasks of a page.
pub const MAX_PAGE_TASKS: usize = 64;

/// What the working memory can be asked and told.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WorldCommand {
    /// The objects that are there, the robot, and since when what is known of them
    /// holds.
    Now,
    /// A page of facts, newest first.
    Facts(FactFilter),
    /// The events after one, oldest first. Answered at once when there are any,
    /// else with the first one that happens, or with none when the time is over.
    Events {
        /// Sequence of the last event that is known already; 0 for all.
        since: u64,
        /// Longest wait, at most [`MAX_EVENT_WAIT_MS`]; 0 for none.
        wait_ms: u64,
    },
    /// A page of tasks, newest first.
    Tasks {
        /// Only tasks with a lower number: the `next` of the page before.
        before: Option<u64>,
        /// Most tasks of the page, up to [`MAX_PAGE_TASKS`].
        limit: u32,
    },
    /// Note that a task begins.
    StartTask {
        /// Identity of this request: the same id again gets the first answer.
        id: MutationId,
        /// What kind of task: a word.
        kind: String,
        /// Its parameters as who starts it writes them.
        parameters: String,
        /// Who starts it.
        author: String,
    },
    /// Note that a task has ended.
    EndTask {
        /// Identity of this request: the same id again gets the first answer.
        id: MutationId,
        /// The task.
        task_id: u64,
        /// How it ended.
        outcome: TaskOutcome,
        /// Why, for people; may be empty when it succeeded.
        reason: String,
    },
}

/// Which facts are wanted: those that held at an instant at which all of this is so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FactFilter {
    /// Only facts about this object.
    pub track_id: Option<u64>,
    /// Their object was called so.
    pub label: Option<String>,
    /// The centre of their object lay there.
    pub region: Option<WorldRegion>,
    /// The instant is this one or later.
    pub since_ns: Option<u64>,
    /// The instant is this one or earlier.
    pub until_ns: Option<u64>,
    /// Only facts with a lower number: the `next` of the page before.
    pub before: Option<u64>,
    /// Most facts of the page, up to [`MAX_PAGE_FACTS`].
    pub limit: u32,
}

impl Default for FactFilter {
    /// A page of all facts.
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

/// A part of the world, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldRegion {
    /// All within a radius of a point.
    Ball {
        /// The point.
        centre_m: [f64; 3],
        /// The radius, 0 or more.
        radius_m: f64,
    },
    /// All between two corners.
    Box {
        /// The least coordinates.
        min_m: [f64; 3],
        /// The greatest coordinates.
        max_m: [f64; 3],
    },
}

/// How a task ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskOutcome {
    /// As it should.
    Succeeded,
    /// It could not be done.
    Failed,
    /// Somebody ended it.
    Cancelled,
}

/// The answer to a [`WorldCommand`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WorldReply {
    /// To [`WorldCommand::Now`].
    Now(WorldReport),
    /// To [`WorldCommand::Facts`].
    Facts(FactsReport),
    /// To [`WorldCommand::Events`].
    Events(EventsReport),
    /// To [`WorldCommand::Tasks`].
    Tasks(TasksReport),
    /// To start and end of a task: on disk.
    Task(TaskReport),
}

/// What is known to be there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldReport {
    /// When this was so.
    pub now_ns: u64,
    /// The objects, by track-id.
    pub objects: Vec<WorldObjectReport>,
    /// The robot; null when it was never heard of.
    pub robot: Option<WorldRobotReport>,
    /// Sequence of the newest event.
    pub newest_event: u64,
}

/// An object, and since when what is known of it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldObjectReport {
    /// The track-id.
    pub track_id: u64,
    /// `tracked`, `missing`, `occluded` or `out-of-view`.
    pub state: String,
    /// Since when.
    pub state_since_ns: u64,
    /// The category; null when unknown.
    pub label: Option<String>,
    /// Since when; null when unknown.
    pub label_since_ns: Option<u64>,
    /// Where it is.
    pub place: PlaceReport,
    /// Since when it has been there, but for less than a motion.
    pub place_since_ns: u64,
    /// When its track began.
    pub first_seen_ns: u64,
    /// When it was last measured.
    pub last_seen_ns: u64,
}

/// The box of an object in the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceReport {
    /// Centre, metres.
    pub position_m: [f64; 3],
    /// Orientation: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Full lengths of the sides, metres.
    pub size_m: [f64; 3],
}

/// The robot as it said it was last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldRobotReport {
    /// What its arm is doing: idle, moving, opening, closing, stopped or failed.
    pub activity: String,
    /// Whether the fingers hold something.
    pub is_holding: bool,
    /// Why the last command failed, empty otherwise.
    pub note: String,
    /// Distance between the fingers, metres.
    pub opening_m: f64,
    /// Angles from the base outwards, radians.
    pub joint_angles_rad: Vec<f64>,
    /// Position of the gripper, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// When it last said so.
    pub last_heard_ns: u64,
    /// Whether it still does.
    pub is_heard: bool,
}

/// Something that holds, or held, for a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactReport {
    /// Its number; numbers grow in the order in which facts are noticed.
    pub fact: u64,
    /// `object`, `robot` or `task`.
    pub subject: String,
    /// The object; null for another subject.
    pub track_id: Option<u64>,
    /// The task; null for another subject.
    pub task_id: Option<u64>,
    /// `state`, `label`, `place`, `activity` or `holding`.
    pub property: String,
    /// The word; for `holding` `yes` or `no`; null for a place.
    pub value: Option<String>,
    /// The place; null for another property.
    pub place: Option<PlaceReport>,
    /// Since when it holds.
    pub start_ns: u64,
    /// Until when it held; null while it holds.
    pub end_ns: Option<u64>,
}

/// Facts, newest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactsReport {
    /// The facts.
    pub facts: Vec<FactReport>,
    /// Where the next page begins; null after the last one.
    pub next: Option<u64>,
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventReport {
    /// Grows from event to event; a start of the memory leaves a gap.
    pub sequence: u64,
    /// When it was noticed.
    pub wall_ns: u64,
    /// `started`, `appeared`, `vanished`, `relabelled`, `moved`, `taught`,
    /// `corrected`, `forgot`, `action_succeeded`, `action_failed`,
    /// `action_cancelled`, `task_started`, `task_succeeded`, `task_failed` or
    /// `task_cancelled`.
    pub event: String,
    /// The object; null when it is not about one.
    pub track_id: Option<u64>,
    /// The task; null when it is not about one.
    pub task_id: Option<u64>,
    /// The category it is about, after the event; null for none.
    pub label: Option<String>,
    /// What happened, for people.
    pub sentence: String,
}

/// Events, oldest first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventsReport {
    /// The events.
    pub events: Vec<EventReport>,
    /// Sequence of the newest event of all: when it is greater than that of the last
    /// one here, ask again at once; when it is less than `since`, the memory was
    /// begun anew, and 0 is where to go on.
    pub newest: u64,
}

/// A task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskReport {
    /// Its number.
    pub task_id: u64,
    /// What kind of task.
    pub kind: String,
    /// Its parameters.
    pub parameters: String,
    /// Who started it.
    pub author: String,
    /// `running`, `succeeded`, `failed` or `cancelled`.
    pub state: String,
    /// When it began.
    pub started_ns: u64,
    /// When it ended; null while it runs.
    pub ended_ns: Option<u64>,
    /// Why it ended, empty when nobody said.
    pub reason: String,
}

/// Tasks, newest first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TasksReport {
    /// The tasks.
    pub tasks: Vec<TaskReport>,
    /// Where the next page begins; null after the last one.
    pub next: Option<u64>,
}
