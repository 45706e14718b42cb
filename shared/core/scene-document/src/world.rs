//! Documents of the world model: present objects, surfaces and robot, and facts with their validity.

use crate::object::CategoryAnswer;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Current state of the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorldDocument {
    /// Time of the world report, nanoseconds since 1970.
    pub now_ns: u64,
    /// Age of the newest scene, seconds, as in
    /// [`SceneDocument`](crate::SceneDocument::scene_age_s); null before the first one.
    #[serde(default)]
    pub scene_age_s: Option<f64>,
    /// Capture time of the newest scene, as in
    /// [`SceneDocument`](crate::SceneDocument::capture_stamp_ns); null before the first one.
    #[serde(default)]
    pub capture_stamp_ns: Option<u64>,
    /// True if the objects are not those of the present: no scene has come for too long, or none
    /// yet.
    #[serde(default)]
    pub is_stale: bool,
    /// Objects of the world model, ordered by track-id.
    pub objects: Vec<WorldObjectDocument>,
    /// Support surfaces of the world model, in the order in which they were found.
    #[serde(default)]
    pub surfaces: Vec<WorldSurfaceDocument>,
    /// State of the robot; null when it never reported.
    pub robot: Option<RobotDocument>,
    /// Sequence number of the newest event.
    pub newest_event: u64,
}

/// Object of the working memory, with the start times of its facts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorldObjectDocument {
    /// Track-id of the object.
    pub track_id: u64,
    /// State of the track: `tracked`, `missing`, `occluded` or `out-of-view`; `stale` while the
    /// newest scene is.
    pub state: String,
    /// Time since which the object has been in its state, nanoseconds since 1970.
    pub state_since_ns: u64,
    /// Category name of the object, certain or probable; null when unknown.
    pub label: Option<String>,
    /// Answer about the category: `is`, `probably` or `unknown`.
    #[serde(default)]
    pub answer: CategoryAnswer,
    /// Start of the label; null when unknown.
    pub label_since_ns: Option<u64>,
    /// Oriented bounding box of the object.
    pub place: PlaceDocument,
    /// Start of the stay at this place; movements shorter than a motion do not count.
    pub place_since_ns: u64,
    /// Time of the track's first measurement, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// Time of the object's last measurement, nanoseconds since 1970.
    pub last_seen_ns: u64,
}

/// Support surface of the working memory: a plane that was seen for a second at least.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorldSurfaceDocument {
    /// Number of the surface, never used again; a surface that was moved is another one.
    pub surface_id: u64,
    /// Kind of the surface, as in [`SurfaceDocument::kind`](crate::SurfaceDocument::kind).
    pub kind: String,
    /// State of the surface: `seen` when the newest scene shows it, `unseen`, or `stale` while the
    /// newest scene is.
    pub state: String,
    /// Upward unit normal of its plane, world frame.
    pub normal: [f64; 3],
    /// Offset of its plane, metres: a point lies on it where its product with the normal and the
    /// offset sum to zero.
    pub offset_m: f64,
    /// Corners of the convex hull of what was seen of it last, world frame, metres, in order around
    /// it.
    pub outline_m: Vec<[f64; 3]>,
    /// Track-ids of the objects on and over it.
    pub track_ids: Vec<u64>,
    /// Time of the first observation, nanoseconds since 1970.
    pub first_seen_ns: u64,
    /// Time of the last observation, nanoseconds since 1970.
    pub last_seen_ns: u64,
}

/// Bounding box of an object in the world frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlaceDocument {
    /// Centre of the object's box, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the object's box, metres.
    pub size_m: [f64; 3],
}

/// Last reported state of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RobotDocument {
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FactDocument {
    /// Number of the fact, ascending in the order of observation.
    pub fact: u64,
    /// Subject of the fact: `object`, `robot`, `task` or `surface`.
    pub subject: String,
    /// Track-id of the object; null for another subject.
    pub track_id: Option<u64>,
    /// Number of the task; null for another subject.
    pub task_id: Option<u64>,
    /// Number of the surface; null for another subject.
    #[serde(default)]
    pub surface_id: Option<u64>,
    /// Property: `state`, `label`, `place`, `activity` or `holding`.
    pub property: String,
    /// Value as a word; `yes` or `no` for `holding`; null for a place.
    pub value: Option<String>,
    /// Answer of a label: `is` or `probably`; null for another property.
    #[serde(default)]
    pub answer: Option<CategoryAnswer>,
    /// Bounding box for `place`; null for another property.
    pub place: Option<PlaceDocument>,
    /// Start of the fact's validity interval, nanoseconds since 1970.
    pub start_ns: u64,
    /// End of the interval; null while the fact holds.
    pub end_ns: Option<u64>,
}

/// Page of facts, newest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FactsDocument {
    /// Facts that match the query.
    pub facts: Vec<FactDocument>,
    /// Cursor of the next page; null after the last page.
    pub next: Option<u64>,
}
