//! Reports to people and scripts: the documents that `--json` prints.

use crate::control::ignored::{AssumptionReport, IgnoredReport};
use crate::{Health, ProcessKind, ProcessState, SceneObject, SceneSummary, TrackState};
use detection::Assumptions;
use serde::{Deserialize, Serialize};

/// All tracked objects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectsReport {
    /// The objects, by track-id.
    pub objects: Vec<ObjectReport>,
    /// Objects that did not fit into the summary.
    pub n_more: u32,
    /// Sequence of the frame.
    pub frame_sequence: u64,
    /// Name of the source or file of the frame.
    pub source_name: String,
    /// Whether a table was found.
    pub has_table: bool,
    /// Whether the camera's pose is known; otherwise world = camera frame.
    pub has_world_pose: bool,
    /// The rule by which a candidate begins a track.
    #[serde(default)]
    pub rule: String,
    /// What was taken for granted where a source was absent.
    #[serde(default)]
    pub assumptions: Vec<AssumptionReport>,
    /// What is there and is no object, nearest first.
    #[serde(default)]
    pub ignored: Vec<IgnoredReport>,
    /// What is ignored and did not fit into the summary.
    #[serde(default)]
    pub n_more_ignored: u32,
}

/// One tracked object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectReport {
    /// The track-id.
    pub track_id: u64,
    /// `tentative`, `tracked` or `missing`.
    pub state: String,
    /// The category; null when unknown.
    pub label: Option<String>,
    /// Dissimilarity to the nearest stored view; null when nothing is stored.
    pub distance: Option<f64>,
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Full lengths of the box's sides, metres.
    pub size_m: [f64; 3],
    /// Capture time since the track began, seconds.
    pub age_s: f64,
    /// Capture time since the track was last measured, seconds.
    pub unseen_s: f64,
    /// Measured points.
    pub n_points: u32,
    /// Views described so far.
    pub n_views: u32,
    /// Mean colour: red, green, blue.
    pub mean_rgb: [u8; 3],
    /// Whether the image border cuts the object.
    pub cut_by_image: bool,
    /// History sequence of the memory the label was made with.
    pub memory_sequence: u64,
}

/// A change of what was learned, on disk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LearningReport {
    /// History sequence of the change.
    pub sequence: u64,
    /// The category.
    pub category: String,
    /// How many views changed their category.
    pub n_views_changed: u64,
}

/// One learned category.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CategoryReport {
    /// The name.
    pub category: String,
    /// Stored views.
    pub n_views: u64,
    /// Bytes of their records.
    pub bytes: u64,
    /// When it was last taught, nanoseconds since 1970.
    pub last_taught_ns: i64,
}

/// One process of the daemon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessReport {
    /// `camera`, `perception`, `memory`.
    pub process: String,
    /// Process id.
    pub pid: u32,
    /// `starting`, `ready`, `degraded`, `idle`, `stopping`.
    pub state: String,
    /// Time since its start, seconds.
    pub uptime_s: f64,
    /// Frames published, processed or persisted.
    pub frames: u64,
    /// Frames that should have been handled and were not.
    pub frames_dropped: u64,
    /// Frames published more than a period late.
    pub frames_late: u64,
    /// Heap bytes requested since start.
    pub allocated_bytes: u64,
    /// Memory resident now, bytes.
    pub resident_bytes: u64,
    /// Shared memory reserved by its publishers, bytes.
    pub shared_memory_bytes: u64,
    /// Restarts inside the process.
    pub restarts: u64,
    /// A sentence about the state, empty when all is well.
    pub note: String,
}

impl ObjectsReport {
    /// The report of a scene.
    pub fn new(scene: &SceneSummary, objects: &[SceneObject]) -> Self {
        let report = |object| ObjectReport::new(object, scene.stamps.capture_ns);
        let objects: Vec<_> = objects.iter().map(report).collect();
        Self {
            n_more: scene.n_objects_total.saturating_sub(objects.len() as u32),
            objects,
            frame_sequence: scene.sequence,
            source_name: scene.source_name.as_str().unwrap_or_default().to_owned(),
            has_table: scene.has_table == 1,
            has_world_pose: scene.frame_flags & crate::frame_flag::HAS_WORLD_POSE != 0,
            rule: scene.rule.as_str().unwrap_or_default().to_owned(),
            assumptions: Assumptions::from_bits(scene.assumptions)
                .iter()
                .map(AssumptionReport::from)
                .collect(),
            ignored: scene.ignored().iter().map(IgnoredReport::from).collect(),
            n_more_ignored: scene
                .n_rejected
                .saturating_sub(scene.ignored().len() as u32),
        }
    }
}

impl ObjectReport {
    /// The report of an object in a scene captured at `capture_ns`.
    pub fn new(object: &SceneObject, capture_ns: u64) -> Self {
        let since_s = |stamp_ns: u64| capture_ns.saturating_sub(stamp_ns) as f64 * 1e-9;
        let [_, red, green, blue] = object.mean_argb.to_be_bytes();
        Self {
            track_id: object.track_id,
            state: TrackState::from_code(object.state)
                .map_or("unknown", TrackState::word)
                .into(),
            label: object.label().map(str::to_owned),
            distance: object
                .distance
                .is_finite()
                .then(|| shortest(object.distance)),
            position_m: object.pose.position_m,
            orientation_xyzw: object.pose.orientation_xyzw,
            size_m: object.size_m.map(shortest),
            age_s: since_s(object.first_seen_ns),
            unseen_s: since_s(object.last_seen_ns),
            n_points: object.n_points,
            n_views: object.n_views,
            mean_rgb: [red, green, blue],
            cut_by_image: object.cut_by_image == 1,
            memory_sequence: object.memory_sequence,
        }
    }
}

/// An `f32` as the `f64` that prints with as few digits: to a tenth of a micrometre.
pub(super) fn shortest(value: f32) -> f64 {
    (f64::from(value) * 1e7).round() / 1e7
}

impl ProcessReport {
    /// The report of a process; `None` when the message is of another version.
    pub fn new(health: &Health) -> Option<Self> {
        if health.schema_version != crate::SCHEMA_VERSION {
            return None;
        }
        let uptime_ns = health.stamp_ns.saturating_sub(health.started_ns);
        Some(Self {
            process: ProcessKind::from_code(health.process)?.name().into(),
            pid: health.pid,
            state: ProcessState::from_code(health.state)?.word().into(),
            uptime_s: uptime_ns as f64 * 1e-9,
            frames: health.frames,
            frames_dropped: health.frames_dropped,
            frames_late: health.frames_late,
            allocated_bytes: health.allocated_bytes,
            resident_bytes: health.resident_bytes,
            shared_memory_bytes: health.shared_memory_bytes,
            restarts: health.restarts,
            note: health.note.as_str().unwrap_or_default().into(),
        })
    }
}
