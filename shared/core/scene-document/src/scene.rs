//! Document of a scene: the tracked objects after one frame, with what they rest on.

use crate::object::ObjectDocument;
use crate::rejected::RejectedDocument;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Scene after one frame: the tracked objects and what they rest on.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct SceneDocument {
    /// Age of the scene at the time of the answer, seconds: the time since the capture of its
    /// frame, in lockstep since its reception; null before the first frame.
    #[serde(default)]
    pub scene_age_s: Option<f64>,
    /// Capture time of the scene's frame, nanoseconds: monotonic clock, or the recording's own
    /// in lockstep; null before the first frame.
    #[serde(default)]
    pub capture_stamp_ns: Option<u64>,
    /// True if the scene does not show the present: no frame has come for too long, or none yet.
    #[serde(default)]
    pub is_stale: bool,
    /// Reason why the scene is stale, as a sentence; empty otherwise.
    #[serde(default)]
    pub note: String,
    /// Tracked objects, ordered by track-id.
    pub objects: Vec<ObjectDocument>,
    /// Number of objects that did not fit into the summary.
    pub n_more: u32,
    /// Session of the camera, as text because it has more digits than many readers of JSON keep;
    /// empty before the first frame.
    #[serde(default)]
    pub session: String,
    /// Sequence number of the reported frame.
    pub frame_sequence: u64,
    /// Name of the camera or recording of the frame.
    pub source_name: String,
    /// Time at which perception received the frame, monotonic clock, nanoseconds; null before the
    /// first frame.
    #[serde(default)]
    pub received_ns: Option<u64>,
    /// Time at which the scene was published, monotonic clock, nanoseconds; null before the first
    /// frame.
    #[serde(default)]
    pub published_ns: Option<u64>,
    /// Number of frames of the session that perception dropped.
    #[serde(default)]
    pub frames_dropped: u64,
    /// Number of object actors that answered too late for the frame.
    #[serde(default)]
    pub n_late: u32,
    /// True if detection found a table.
    pub has_table: bool,
    /// Surfaces that carry objects.
    #[serde(default)]
    pub surfaces: Vec<SurfaceDocument>,
    /// True if the camera pose is known; otherwise the world frame is the camera frame.
    pub has_world_pose: bool,
    /// Pose of the camera in the world, `world_from_camera`; null before the first frame.
    #[serde(default)]
    pub camera: Option<CameraPoseDocument>,
    /// Direction against gravity in the world: z with a camera pose, otherwise the normal of the
    /// table; null without both.
    #[serde(default)]
    pub up: Option<[f64; 3]>,
    /// Rule by which a candidate starts a track.
    #[serde(default)]
    pub rule: String,
    /// Assumptions that detection made for absent inputs.
    #[serde(default)]
    pub assumptions: Vec<AssumptionDocument>,
    /// Rejected candidates, nearest to the camera first.
    #[serde(default)]
    pub ignored: Vec<RejectedDocument>,
    /// Number of rejected candidates that did not fit into the summary.
    #[serde(default)]
    pub n_more_ignored: u32,
}

/// Support surface: a plane that carries objects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurfaceDocument {
    /// Kind of the surface: `table`; `level`, a further one that carries objects, such as the board
    /// of a shelf; `new-level`, one that only the present frame shows; `floor`.
    pub kind: String,
    /// Upward unit normal of its plane, world frame.
    pub normal: [f64; 3],
    /// Offset of its plane, metres: a point lies on it where its product with the normal and the
    /// offset sum to zero.
    pub offset_m: f64,
    /// Corners of the convex hull of what is seen of it, world frame, metres, in order around it.
    #[serde(default)]
    pub outline_m: Vec<[f64; 3]>,
    /// Number of samples of the subsampled image on it: its evidence in this frame.
    #[serde(default)]
    pub n_samples: u32,
    /// Track-ids of the objects on and over it.
    #[serde(default)]
    pub track_ids: Vec<u64>,
}

/// Pose of the camera in the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CameraPoseDocument {
    /// Position in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation in the world, quaternion: x, y, z, w. The camera looks along its z axis, and
    /// its x axis is to the right.
    pub orientation_xyzw: [f64; 4],
}

/// Assumption made in place of an absent input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AssumptionDocument {
    /// Short name of the assumption, for scripts.
    pub name: String,
    /// Description of the assumption as a sentence.
    pub sentence: String,
}
