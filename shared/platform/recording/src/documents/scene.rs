//! Documents of the scene: tracked objects and rejected candidates after one frame.

use super::{pose, session, text};
use crate::document::document;
use constraint::Ternary;
use message::{RejectedCandidate, SceneObject, SceneSummary, TrackState};

document! {
    /// Candidate category of an object.
    CategoryDocument = "tabula.NearCategory" {
        /// Name of the category.
        category: String,
        /// Distance to its nearest view.
        distance: f32,
        /// Probability of the category, 0 to 1.
        probability: f32,
    }
}

document! {
    /// Tracked object.
    ObjectDocument = "tabula.Object" {
        /// Track-id; never reused.
        track_id: u64,
        /// State of the track: tentative, tracked, missing, occluded or out-of-view.
        state: String,
        /// Category name; empty for an unknown object.
        label: String,
        /// Probability of the best category, 0 to 1; null when nothing is stored.
        probability: f32,
        /// Distance to the nearest stored view; null when nothing is stored.
        distance: f32,
        /// Most probable categories, best first.
        categories: Vec<CategoryDocument>,
        /// Pose of the box, world frame: position in metres, then quaternion x, y, z, w.
        pose: [f64; 7],
        /// Side lengths of the box, metres.
        size_m: [f32; 3],
        /// Velocity of the box's centre, metres per second.
        velocity_m_s: [f32; 3],
        /// Angular velocity, radians per second.
        angular_velocity_rad_s: [f32; 3],
        /// Covariance of the position (xx, xy, xz, yy, yz, zz), square metres.
        position_covariance_m2: [f32; 6],
        /// Covariance of the orientation (xx, xy, xz, yy, yz, zz), square radians.
        rotation_covariance_rad2: [f32; 6],
        /// Number of measured points.
        n_points: u32,
        /// Number of described views so far.
        n_views: u32,
        /// Number of key views so far.
        n_key_views: u32,
        /// True if this frame's view is a key view.
        is_key_view: bool,
        /// True if the image border cuts the object.
        is_cut_by_image: bool,
        /// Mean colour: alpha, red, green, blue from the highest byte to the lowest.
        mean_argb: u32,
        /// Capture time of the first frame with the track, nanoseconds.
        first_seen_ns: u64,
        /// Capture time of the last frame with a measurement, nanoseconds.
        last_seen_ns: u64,
        /// Track-id of the lost track that it continues; 0 for none.
        linked_to: u64,
        /// History sequence of the memory with which the label was recognised.
        memory_sequence: u64,
    }
}

document! {
    /// Candidate that neither started nor continued a track.
    RejectedDocument = "tabula.RejectedCandidate" {
        /// Pose of the box, world frame: position in metres, then quaternion x, y, z, w.
        pose: [f64; 7],
        /// Side lengths of the box, metres.
        size_m: [f32; 3],
        /// Number of measured points.
        n_points: u32,
        /// Verdict of the rule: true, false or unknown.
        verdict: String,
        /// Constraints that decided the verdict, most informative first.
        decisive: Vec<String>,
    }
}

document! {
    /// Scene after one frame.
    SceneDocument = "tabula.Scene" {
        /// Session of the camera.
        session: String,
        /// Sequence number of the frame.
        sequence: u64,
        /// Capture time of the frame, nanoseconds.
        capture_ns: u64,
        /// Time at which perception received the frame, monotonic clock, nanoseconds.
        received_ns: u64,
        /// Time at which the scene was published, monotonic clock, nanoseconds.
        published_ns: u64,
        /// Number of frames of the session that perception dropped.
        frames_dropped: u64,
        /// Number of actors that were late.
        n_late: u32,
        /// True if detection found a table.
        has_table: bool,
        /// Plane of the table, world frame: unit normal and offset, metres.
        table_plane: [f64; 4],
        /// Bits of the assumptions made for absent inputs.
        assumptions: u32,
        /// Rule by which a candidate starts a track.
        rule: String,
        /// Name of the camera or recording.
        source: String,
        /// Tracked objects, by track-id.
        objects: Vec<ObjectDocument>,
        /// Number of rejected candidates; larger than their list when they do not all fit.
        n_rejected: u32,
        /// Rejected candidates, nearest to the camera first.
        rejected: Vec<RejectedDocument>,
    }
}

impl From<&SceneObject> for ObjectDocument {
    fn from(object: &SceneObject) -> Self {
        let categories = object.categories();
        Self {
            track_id: object.track_id,
            state: TrackState::from_code(object.state)
                .map_or("unknown", TrackState::word)
                .into(),
            label: object.label().unwrap_or_default().into(),
            probability: object.probability,
            distance: object.distance,
            categories: categories
                .map(|(category, distance, probability)| CategoryDocument {
                    category: category.into(),
                    distance,
                    probability,
                })
                .collect(),
            pose: pose(&object.pose),
            size_m: object.size_m,
            velocity_m_s: object.velocity_m_s,
            angular_velocity_rad_s: object.angular_velocity_rad_s,
            position_covariance_m2: object.position_covariance_m2,
            rotation_covariance_rad2: object.rotation_covariance_rad2,
            n_points: object.n_points,
            n_views: object.n_views,
            n_key_views: object.n_key_views,
            is_key_view: object.is_key_view == 1,
            is_cut_by_image: object.cut_by_image == 1,
            mean_argb: object.mean_argb,
            first_seen_ns: object.first_seen_ns,
            last_seen_ns: object.last_seen_ns,
            linked_to: object.linked_to,
            memory_sequence: object.memory_sequence,
        }
    }
}

impl From<&RejectedCandidate> for RejectedDocument {
    fn from(rejected: &RejectedCandidate) -> Self {
        let verdict = rejected.verdict().map_or("unknown", Ternary::word);
        let decisive = rejected.decisive_findings();
        Self {
            pose: pose(&rejected.pose),
            size_m: rejected.size_m,
            n_points: rejected.n_points,
            verdict: verdict.into(),
            decisive: decisive
                .map(|(constraint, finding)| format!("{}: {}", constraint.name(), finding.reason))
                .collect(),
        }
    }
}

impl SceneDocument {
    /// Document of a scene and its objects.
    pub fn new(scene: &SceneSummary, objects: &[SceneObject]) -> Self {
        Self {
            session: session(scene.session),
            sequence: scene.sequence,
            capture_ns: scene.stamps.capture_ns,
            received_ns: scene.stamps.received_ns,
            published_ns: scene.stamps.published_ns,
            frames_dropped: scene.frames_dropped,
            n_late: scene.n_late,
            has_table: scene.has_table == 1,
            table_plane: scene.table_plane,
            assumptions: scene.assumptions,
            rule: text(&scene.rule),
            source: text(&scene.source_name),
            objects: objects.iter().map(ObjectDocument::from).collect(),
            n_rejected: scene.n_rejected,
            rejected: scene
                .rejected_candidates()
                .iter()
                .map(RejectedDocument::from)
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scene_without_stored_views_has_null_distances() {
        let object = SceneObject {
            track_id: 3,
            state: TrackState::Tracked.code(),
            ..SceneObject::default()
        };
        let document = SceneDocument::new(&SceneSummary::default(), &[object]);
        let json = serde_json::to_value(&document).unwrap();
        assert_eq!(json["objects"][0]["track_id"], 3);
        assert_eq!(json["objects"][0]["state"], "tracked");
        assert!(json["objects"][0]["distance"].is_null());
    }
}
