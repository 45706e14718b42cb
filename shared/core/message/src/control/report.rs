//! Reports to people and scripts: the documents that `--json` prints.

use crate::control::ignored::{AssumptionReport, IgnoredReport};
use crate::pose::is_covariance;
use crate::{
    ActorStamps, Health, ProcessKind, ProcessState, SceneObject, SceneSummary, TrackState,
};
use constraint::Assumptions;
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
    /// `tentative`, `tracked`, `missing`, `occluded` or `out-of-view`.
    pub state: String,
    /// The category; null when unknown.
    pub label: Option<String>,
    /// Dissimilarity to the nearest stored view; null when nothing is stored.
    pub distance: Option<f64>,
    /// Probability that it belongs to the nearest category; null when nothing is
    /// stored.
    pub probability: Option<f64>,
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
    /// How uncertain the pose is; null when that is not known.
    #[serde(default)]
    pub covariance: Option<CovarianceReport>,
    /// Velocity of the box's centre, world axes, metres a second; null when not known.
    #[serde(default)]
    pub velocity_m_s: Option<[f64; 3]>,
    /// Angular velocity, world axes, radians a second; null when not known.
    #[serde(default)]
    pub angular_velocity_rad_s: Option<[f64; 3]>,
    /// Number of the newest view, from 0; null before the first.
    #[serde(default)]
    pub view: Option<u32>,
    /// Whether this frame's view is a key view.
    #[serde(default)]
    pub is_key_view: bool,
    /// Key views so far.
    #[serde(default)]
    pub n_key_views: u32,
    /// The nearest categories, nearest first.
    #[serde(default)]
    pub categories: Vec<NearCategoryReport>,
    /// The lost track this object is taken to continue; null for none.
    #[serde(default)]
    pub linked_to: Option<u64>,
    /// When the newest view passed the object's actor.
    #[serde(default)]
    pub stamps: ActorStampsReport,
}

/// How uncertain a pose is: xx, xy, xz, yy, yz, zz of each matrix, world axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CovarianceReport {
    /// Of the position, square metres.
    pub position_m2: [f64; 6],
    /// Of a small rotation, square radians.
    pub rotation_rad2: [f64; 6],
}

/// A category and how far an object is from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NearCategoryReport {
    /// The category.
    pub label: String,
    /// Dissimilarity to its nearest view.
    pub distance: f64,
}

/// When a view passed its actor, nanoseconds of the monotonic clock; null where it
/// has not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ActorStampsReport {
    /// Handed to the actor.
    pub asked_ns: Option<u64>,
    /// Begun by the actor.
    pub begun_ns: Option<u64>,
    /// Described.
    pub described_ns: Option<u64>,
    /// Compared with what was taught.
    pub recognised_ns: Option<u64>,
    /// Answered to the frame loop.
    pub answered_ns: Option<u64>,
}

impl From<&ActorStamps> for ActorStampsReport {
    fn from(stamps: &ActorStamps) -> Self {
        let stamp = |ns: u64| (ns != 0).then_some(ns);
        Self {
            asked_ns: stamp(stamps.asked_ns),
            begun_ns: stamp(stamps.begun_ns),
            described_ns: stamp(stamps.described_ns),
            recognised_ns: stamp(stamps.recognised_ns),
            answered_ns: stamp(stamps.answered_ns),
        }
    }
}

impl CovarianceReport {
    fn of(object: &SceneObject) -> Option<Self> {
        let given = [
            &object.position_covariance_m2,
            &object.rotation_covariance_rad2,
        ];
        let [position_m2, rotation_rad2] = given.map(|six| six.map(f64::from));
        given.into_iter().all(is_covariance).then_some(Self {
            position_m2,
            rotation_rad2,
        })
    }
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
    /// Actors now.
    #[serde(default)]
    pub actors: u64,
    /// Worker threads that were left behind.
    #[serde(default)]
    pub abandoned: u64,
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
            probability: object
                .probability
                .is_finite()
                .then(|| shortest(object.probability)),
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
            covariance: CovarianceReport::of(object),
            velocity_m_s: finite(object.velocity_m_s),
            angular_velocity_rad_s: finite(object.angular_velocity_rad_s),
            view: object.view(),
            is_key_view: object.is_key_view == 1,
            n_key_views: object.n_key_views,
            categories: object
                .categories()
                .map(|(label, distance)| NearCategoryReport {
                    label: label.to_owned(),
                    distance: shortest(distance),
                })
                .collect(),
            linked_to: object.linked_to(),
            stamps: (&object.stamps).into(),
        }
    }
}

/// Three numbers that are numbers.
fn finite(values: [f32; 3]) -> Option<[f64; 3]> {
    let are_finite = values.iter().all(|value| value.is_finite());
    are_finite.then(|| values.map(shortest))
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
            actors: health.actors,
            abandoned: health.abandoned,
            note: health.note.as_str().unwrap_or_default().into(),
        })
    }
}

#[cfg(test)]
mod tests;
