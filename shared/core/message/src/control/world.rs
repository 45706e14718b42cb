//! Working memory: current and past world facts, events and tasks. Times are wall clock,
//! nanoseconds since 1970.

use super::learning::MutationId;
use serde::{Deserialize, Serialize};

/// Maximum waiting time of [`WorldCommand::Events`] (long polling), milliseconds.
pub const MAX_EVENT_WAIT_MS: u64 = 30_000;

/// Maximum number of facts per page.
pub const MAX_PAGE_FACTS: usize = 500;

/// Maximum number of events per answer.
pub const MAX_PAGE_EVENTS: usize = 128;

/// Maximum number of tasks per page.
pub const MAX_PAGE_TASKS: usize = 64;

/// Query or update of the working memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
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
    Now(WorldReport),
    /// Reply to [`WorldCommand::Facts`].
    Facts(FactsReport),
    /// Reply to [`WorldCommand::Events`].
    Events(EventsReport),
    /// Reply to [`WorldCommand::Tasks`].
    Tasks(TasksReport),
    /// Reply to the start and end of a task: the record is on disk.
    Task(TaskReport),
}

/// Current state of the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldReport {
    /// Time of the world report, nanoseconds since 1970.
    pub now_ns: u64,
    /// Age of the newest scene, seconds, as in
    /// [`ObjectsReport`](super::ObjectsReport::scene_age_s); null before the first one.
    #[serde(default)]
    pub scene_age_s: Option<f64>,
    /// Capture time of the newest scene, as in
    /// [`ObjectsReport`](super::ObjectsReport::capture_stamp_ns); null before the first one.
    #[serde(default)]
    pub capture_stamp_ns: Option<u64>,
    /// True if the objects are not those of the present: no scene has come for too long, or none
    /// yet.
    #[serde(default)]
    pub is_stale: bool,
    /// Objects of the world model, ordered by track-id.
    pub objects: Vec<WorldObjectReport>,
    /// State of the robot; null when it never reported.
    pub robot: Option<WorldRobotReport>,
    /// Sequence number of the newest event.
    pub newest_event: u64,
}

/// Object of the working memory, with the start times of its facts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldObjectReport {
    /// Track-id of the object.
    pub track_id: u64,
    /// State of the track: `tracked`, `missing`, `occluded` or `out-of-view`; `stale` while the
    /// newest scene is.
    pub state: String,
    /// Time since which the object has been in its state, nanoseconds since 1970.
    pub state_since_ns: u64,
    /// Category name of the object; null when unknown.
    pub label: Option<String>,
    /// Start of the label; null when unknown.
    pub label_since_ns: Option<u64>,
    /// Oriented bounding box of the object.
    pub place: PlaceReport,
    /// Start of the stay at this place; movements shorter than a motion do not count.
    pub place_since_ns: u64,
    /// Time of the track's first measurement, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// Time of the object's last measurement, nanoseconds since 1970.
    pub last_seen_ns: u64,
}

/// Bounding box of an object in the world frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceReport {
    /// Centre of the object's box, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the object's box, metres.
    pub size_m: [f64; 3],
}

/// Last reported state of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldRobotReport {
    /// Activity of the arm: `idle`, `moving`, `opening`, `closing`, `stopped` or `failed`.
    pub activity: String,
    /// True if the fingers hold an object.
    pub is_holding: bool,
    /// Reason for the failure of the last command; empty otherwise.
    pub note: String,
    /// Gripper opening: distance between the fingers, metres.
    pub opening_m: f64,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: Vec<f64>,
    /// Position of the gripper, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper, world frame, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Time of the last state report of the robot, nanoseconds since 1970.
    pub last_heard_ns: u64,
    /// True if the robot still sends reports.
    pub is_heard: bool,
}

/// Fact: a property of a subject that holds, or held, for an interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactReport {
    /// Number of the fact, ascending in the order of observation.
    pub fact: u64,
    /// Subject of the fact: `object`, `robot` or `task`.
    pub subject: String,
    /// Track-id of the object; null for another subject.
    pub track_id: Option<u64>,
    /// Number of the task; null for another subject.
    pub task_id: Option<u64>,
    /// Property: `state`, `label`, `place`, `activity` or `holding`.
    pub property: String,
    /// Value as a word; `yes` or `no` for `holding`; null for a place.
    pub value: Option<String>,
    /// Bounding box for `place`; null for another property.
    pub place: Option<PlaceReport>,
    /// Start of the fact's validity interval, nanoseconds since 1970.
    pub start_ns: u64,
    /// End of the interval; null while the fact holds.
    pub end_ns: Option<u64>,
}

/// Page of facts, newest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FactsReport {
    /// Facts that match the query.
    pub facts: Vec<FactReport>,
    /// Cursor of the next page; null after the last page.
    pub next: Option<u64>,
}

/// Event in the world model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventReport {
    /// Sequence of the event, ascending; a restart of the memory leaves a gap.
    pub sequence: u64,
    /// Time at which the event was observed, nanoseconds since 1970.
    pub wall_ns: u64,
    /// Kind of the event: `started`, `appeared`, `vanished`, `relabelled`, `moved`, `taught`,
    /// `corrected`, `forgot`, `action_succeeded`, `action_failed`, `action_cancelled`,
    /// `task_started`, `task_succeeded`, `task_failed` or `task_cancelled`.
    pub event: String,
    /// Track-id; null when no object is involved.
    pub track_id: Option<u64>,
    /// Task id; null when no task is involved.
    pub task_id: Option<u64>,
    /// Category after the event; null for none.
    pub label: Option<String>,
    /// Description of the event, for people.
    pub sentence: String,
}

/// Events, oldest first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventsReport {
    /// Events of the world model, oldest first.
    pub events: Vec<EventReport>,
    /// Sequence of the newest event overall. When it exceeds the last sequence of this answer, ask
    /// again at once; when it is below `since`, the memory was recreated: restart from 0.
    pub newest: u64,
}

/// Record of a task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskReport {
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
    /// Start time of the task, nanoseconds since 1970.
    pub started_ns: u64,
    /// End time; null while the task runs.
    pub ended_ns: Option<u64>,
    /// Reason for the outcome; empty when none was given.
    pub reason: String,
}

/// Page of tasks, newest first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TasksReport {
    /// Running and ended tasks.
    pub tasks: Vec<TaskReport>,
    /// Cursor of the next page; null after the last page.
    pub next: Option<u64>,
}
