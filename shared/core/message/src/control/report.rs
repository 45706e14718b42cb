//! Reports for people and scripts: the documents printed by `--json`.

use crate::control::rejected::{AssumptionReport, RejectedCandidateReport};
use crate::control::rounding::rounded;
use crate::pose::is_covariance;
use crate::{
    ActorStamps, Health, ProcessKind, ProcessState, SceneObject, SceneSummary, SceneTime,
    TrackState, WirePose,
};
use constraint::Assumptions;
use point_cloud::ColorTerm;
use serde::{Deserialize, Serialize};

/// Report of all tracked objects.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ObjectsReport {
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
    pub objects: Vec<ObjectReport>,
    /// Number of objects that did not fit into the summary.
    pub n_more: u32,
    /// Sequence number of the reported frame.
    pub frame_sequence: u64,
    /// Name of the camera or recording of the frame.
    pub source_name: String,
    /// True if detection found a table.
    pub has_table: bool,
    /// True if the camera pose is known; otherwise the world frame is the camera frame.
    pub has_world_pose: bool,
    /// Pose of the camera in the world, `world_from_camera`; null before the first frame.
    #[serde(default)]
    pub camera: Option<CameraPoseReport>,
    /// Direction against gravity in the world: z with a camera pose, otherwise the normal of the
    /// table; null without both.
    #[serde(default)]
    pub up: Option<[f64; 3]>,
    /// Rule by which a candidate starts a track.
    #[serde(default)]
    pub rule: String,
    /// Assumptions that detection made for absent inputs.
    #[serde(default)]
    pub assumptions: Vec<AssumptionReport>,
    /// Rejected candidates, nearest to the camera first.
    #[serde(default)]
    pub ignored: Vec<RejectedCandidateReport>,
    /// Number of rejected candidates that did not fit into the summary.
    #[serde(default)]
    pub n_more_ignored: u32,
}

/// Pose of the camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CameraPoseReport {
    /// Position in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation in the world, quaternion: x, y, z, w. The camera looks along its z axis, and
    /// its x axis is to the right.
    pub orientation_xyzw: [f64; 4],
}

/// Report of one tracked object.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ObjectReport {
    /// Track-id of the object.
    pub track_id: u64,
    /// State of the track: `tentative`, `tracked`, `missing`, `occluded` or `out-of-view`;
    /// `stale` while the scene is, because nothing is known about the present then.
    pub state: String,
    /// Age of the scene, as in [`ObjectsReport::scene_age_s`].
    #[serde(default)]
    pub scene_age_s: Option<f64>,
    /// Capture time of the scene's frame, as in [`ObjectsReport::capture_stamp_ns`].
    #[serde(default)]
    pub capture_stamp_ns: Option<u64>,
    /// Category name of the object; null when unknown.
    pub label: Option<String>,
    /// Distance in descriptor space to the nearest stored view; null when nothing is stored.
    pub distance: Option<f64>,
    /// Probability that the object belongs to the best category; null when nothing is stored.
    pub probability: Option<f64>,
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the object's box, metres.
    pub size_m: [f64; 3],
    /// Age of the track in capture time, seconds.
    pub age_s: f64,
    /// Time since the capture in which the object was last measured, seconds. It goes on while
    /// no frame comes, except in lockstep.
    pub unseen_s: f64,
    /// Number of measured points of the object.
    pub n_points: u32,
    /// Number of described views of the object so far.
    pub n_views: u32,
    /// Mean colour of the object: red, green, blue.
    pub mean_rgb: [u8; 3],
    /// Basic colour terms of the object, greatest share first.
    #[serde(default)]
    pub colors: Vec<ColorShareReport>,
    /// True if the image border cuts the object.
    pub cut_by_image: bool,
    /// History sequence of the memory with which the label was recognised.
    pub memory_sequence: u64,
    /// Covariance of the pose; null when unknown.
    #[serde(default)]
    pub covariance: Option<CovarianceReport>,
    /// Velocity of the box's centre, world axes, metres per second; null when unknown.
    #[serde(default)]
    pub velocity_m_s: Option<[f64; 3]>,
    /// Angular velocity, world axes, radians per second; null when unknown.
    #[serde(default)]
    pub angular_velocity_rad_s: Option<[f64; 3]>,
    /// Number of the newest view, from 0; null before the first view.
    #[serde(default)]
    pub view: Option<u32>,
    /// True if this frame's view is a key view.
    #[serde(default)]
    pub is_key_view: bool,
    /// Number of key views of the object so far.
    #[serde(default)]
    pub n_key_views: u32,
    /// Number of different sides of the object that the label rests on.
    #[serde(default)]
    pub n_sides: u32,
    /// Most probable categories, best first.
    #[serde(default)]
    pub categories: Vec<NearCategoryReport>,
    /// Track-id of the lost track that this object continues; null for none.
    #[serde(default)]
    pub linked_to: Option<u64>,
    /// Processing times of the newest view in the object's actor.
    #[serde(default)]
    pub stamps: ActorStampsReport,
}

/// Covariance of a pose, each matrix packed as xx, xy, xz, yy, yz, zz, world axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CovarianceReport {
    /// Covariance of the object's position, square metres.
    pub position_m2: [f64; 6],
    /// Covariance of a small rotation vector, square radians.
    pub rotation_rad2: [f64; 6],
}

/// Basic colour term with its share of an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ColorShareReport {
    /// Colour term: `black`, `white`, `grey`, `red`, `green`, `yellow`, `blue`, `brown`, `orange`,
    /// `pink` or `purple`.
    pub color: String,
    /// Share of the object's measured points, 0 to 1, in hundredths.
    pub share: f64,
}

/// Candidate category of an object with its descriptor distance and probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NearCategoryReport {
    /// Name of the nearby category.
    pub label: String,
    /// Distance in descriptor space to the category's nearest view.
    pub distance: f64,
    /// Probability that the object belongs to the category, 0 to 1.
    #[serde(default)]
    pub probability: f64,
}

/// Processing times of a view in its actor, monotonic clock, nanoseconds; null when not
/// reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ActorStampsReport {
    /// Time at which the view was sent to the actor.
    pub asked_ns: Option<u64>,
    /// Time at which the actor began to process the view.
    pub begun_ns: Option<u64>,
    /// Time at which the descriptor was complete.
    pub described_ns: Option<u64>,
    /// Time at which the recognition of the view was complete.
    pub recognised_ns: Option<u64>,
    /// Time at which the frame loop received the actor's answer.
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

impl CameraPoseReport {
    /// Report of a camera pose; `None` for one that is no pose.
    fn of(world_from_camera: &WirePose) -> Option<Self> {
        world_from_camera.checked().map(|_| Self {
            position_m: world_from_camera.position_m,
            orientation_xyzw: world_from_camera.orientation_xyzw,
        })
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

/// Report of the depth noise that perception measures on the table.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DepthNoiseReport {
    /// Name of the configured law: `kinect-v1`, `stereo` or `time-of-flight`.
    pub law: String,
    /// Ratio of the measured noise and warp to the law, 1 to 4, median of up to 10 s; null
    /// before a table was seen for a second.
    pub ratio: Option<f64>,
    /// Depth of the middle of the table along the optical axis, metres; null before a table was
    /// seen.
    pub table_depth_m: Option<f64>,
}

/// Confirmation of a durable change of learned views.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LearningReport {
    /// History sequence number of the change.
    pub sequence: u64,
    /// Name of the affected category.
    pub category: String,
    /// Number of views that changed their category.
    pub n_views_changed: u64,
}

/// Report of one learned category.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CategoryReport {
    /// Name of the learned category.
    pub category: String,
    /// Number of stored views of the category.
    pub n_views: u64,
    /// Size of the category's view records, bytes.
    pub bytes: u64,
    /// Time of the last teaching, nanoseconds since 1970.
    pub last_taught_ns: i64,
}

/// Health report of one process of the daemon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessReport {
    /// Name of the process: `camera`, `perception`, `memory` or `simulator`.
    pub process: String,
    /// Operating-system process id.
    pub pid: u32,
    /// State: `starting`, `ready`, `degraded`, `idle` or `stopping`.
    pub state: String,
    /// Time since the process started, seconds.
    pub uptime_s: f64,
    /// Number of frames published, processed or persisted.
    pub frames: u64,
    /// Number of frames dropped: due but not handled.
    pub frames_dropped: u64,
    /// Number of frames published more than a period late.
    pub frames_late: u64,
    /// Heap bytes allocated by the process since its start.
    pub allocated_bytes: u64,
    /// Resident memory of the process, bytes.
    pub resident_bytes: u64,
    /// Shared memory reserved by the publishers of the process, bytes.
    pub shared_memory_bytes: u64,
    /// Number of actor restarts within the process.
    pub restarts: u64,
    /// Number of live actors in the process.
    #[serde(default)]
    pub actors: u64,
    /// Number of abandoned worker threads.
    #[serde(default)]
    pub abandoned: u64,
    /// Explanation of the state as a sentence; empty when nothing is wrong.
    pub note: String,
}

impl ObjectsReport {
    /// Creates the report of a scene at a time of the monotonic clock, nanoseconds.
    pub fn new(scene: &SceneSummary, objects: &[SceneObject], now_ns: u64) -> Self {
        let time = scene.time();
        let report = |object| ObjectReport::new(object, time, now_ns);
        let objects: Vec<_> = objects.iter().map(report).collect();
        let is_stale = time.is_stale(now_ns);
        Self {
            scene_age_s: Some(time.age_s(now_ns)),
            capture_stamp_ns: Some(time.capture_ns),
            is_stale,
            note: if is_stale {
                stale_sentence(time.age_s(now_ns))
            } else {
                String::new()
            },
            n_more: scene.n_objects_total.saturating_sub(objects.len() as u32),
            objects,
            frame_sequence: scene.sequence,
            source_name: scene.source_name.as_str().unwrap_or_default().to_owned(),
            has_table: scene.has_table == 1,
            has_world_pose: has_world_pose(scene),
            camera: CameraPoseReport::of(&scene.world_from_camera),
            up: up(scene),
            rule: scene.rule.as_str().unwrap_or_default().to_owned(),
            assumptions: Assumptions::from_bits(scene.assumptions)
                .iter()
                .map(AssumptionReport::from)
                .collect(),
            ignored: scene
                .rejected_candidates()
                .iter()
                .map(RejectedCandidateReport::from)
                .collect(),
            n_more_ignored: scene
                .n_rejected
                .saturating_sub(scene.rejected_candidates().len() as u32),
        }
    }
}

impl ObjectReport {
    /// Creates the report of an object in a scene at a time of the monotonic clock,
    /// nanoseconds.
    pub fn new(object: &SceneObject, scene: SceneTime, now_ns: u64) -> Self {
        let seconds = |from_ns: u64, to_ns: u64| to_ns.saturating_sub(from_ns) as f64 * 1e-9;
        let [_, red, green, blue] = object.mean_argb.to_be_bytes();
        let state = TrackState::from_code(object.state).map_or("unknown", TrackState::word);
        Self {
            track_id: object.track_id,
            state: if scene.is_stale(now_ns) {
                TrackState::STALE_WORD
            } else {
                state
            }
            .into(),
            scene_age_s: Some(scene.age_s(now_ns)),
            capture_stamp_ns: Some(scene.capture_ns),
            label: object.label().map(str::to_owned),
            distance: object
                .distance
                .is_finite()
                .then(|| rounded(object.distance)),
            probability: object
                .probability
                .is_finite()
                .then(|| rounded(object.probability)),
            position_m: object.pose.position_m,
            orientation_xyzw: object.pose.orientation_xyzw,
            size_m: object.size_m.map(rounded),
            age_s: seconds(object.first_seen_ns, scene.capture_ns),
            unseen_s: seconds(object.last_seen_ns, scene.present_ns(now_ns)),
            n_points: object.n_points,
            n_views: object.n_views,
            mean_rgb: [red, green, blue],
            colors: color_shares(object),
            cut_by_image: object.cut_by_image == 1,
            memory_sequence: object.memory_sequence,
            covariance: CovarianceReport::of(object),
            velocity_m_s: finite(object.velocity_m_s),
            angular_velocity_rad_s: finite(object.angular_velocity_rad_s),
            view: object.view(),
            is_key_view: object.is_key_view == 1,
            n_key_views: object.n_key_views,
            n_sides: object.n_sides,
            categories: object
                .categories()
                .map(|(label, distance, probability)| NearCategoryReport {
                    label: label.to_owned(),
                    distance: rounded(distance),
                    probability: rounded(probability),
                })
                .collect(),
            linked_to: object.linked_to(),
            stamps: (&object.stamps).into(),
        }
    }
}

fn has_world_pose(scene: &SceneSummary) -> bool {
    scene.frame_flags & crate::frame_flag::HAS_WORLD_POSE != 0
}

/// Direction against gravity in the world, as far as it is known.
fn up(scene: &SceneSummary) -> Option<[f64; 3]> {
    let [x, y, z, _] = scene.table_plane;
    if has_world_pose(scene) {
        Some([0.0, 0.0, 1.0])
    } else {
        (scene.has_table == 1).then_some([x, y, z])
    }
}

/// Colour terms of an object with a share, greatest first.
fn color_shares(object: &SceneObject) -> Vec<ColorShareReport> {
    let shares = ColorTerm::ALL.into_iter().zip(object.color_percents);
    let mut shares: Vec<_> = shares.filter(|(_, percent)| *percent > 0).collect();
    shares.sort_by_key(|(_, percent)| std::cmp::Reverse(*percent));
    let report = |(term, percent): (ColorTerm, u8)| ColorShareReport {
        color: term.word().to_owned(),
        share: f64::from(percent) / 100.0,
    };
    shares.into_iter().map(report).collect()
}

/// Sentence about a scene that no longer shows the present.
fn stale_sentence(age_s: f64) -> String {
    format!(
        "no frame was processed for {age_s:.1} s: the objects are where they were then, and may be \
         elsewhere now; see the camera in `tabula status`"
    )
}

/// Rounded vector; `None` when a component is not finite.
fn finite(values: [f32; 3]) -> Option<[f64; 3]> {
    let are_finite = values.iter().all(|value| value.is_finite());
    are_finite.then(|| values.map(rounded))
}

impl ProcessReport {
    /// Creates the report of a process; `None` for another schema version.
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
