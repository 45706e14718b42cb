//! Track of one object.

use crate::candidate_measurement::CandidateMeasurement;
use crate::table_height::TableHeight;
use crate::track_initiation::ProspectiveObject;
use geometry::OrientedBox;
use learning::{Recognition, TrackEvidence};
use nalgebra::{Matrix3, Vector3};
use tracking::{CoarseAppearance, MotionFilter, OcclusionState, TrackLifecycle, Visibility};

/// Track of one object: motion, appearance and recognition result.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Track-id, never reused.
    pub id: u64,
    /// Capture stamp of the first measurement, nanoseconds.
    pub first_seen_ns: u64,
    /// Capture stamp of the last measurement, nanoseconds.
    pub last_seen_ns: u64,
    /// Last measurement of the object.
    pub measured: CandidateMeasurement,
    /// Number of views that were described.
    pub n_views: u32,
    /// Number of key views of the track.
    pub n_key_views: u32,
    /// Track-id of the earlier, lost track with which this object was re-identified by appearance.
    pub reidentified_as: Option<u64>,
    /// Evidence of the sides that were seen, with the label read from it: the only place of both.
    pub(crate) evidence: TrackEvidence,
    pub(crate) lifecycle: TrackLifecycle,
    /// Motion state after the last measurement update.
    pub(crate) updated_filter: MotionFilter,
    /// Motion state predicted to the last frame.
    pub(crate) filter: MotionFilter,
    /// Remembered appearance of the object for data association.
    pub(crate) appearance: CoarseAppearance,
    /// Capture stamp of the last measurement with hand contact; 0 for none.
    pub(crate) last_handled_ns: u64,
    /// Height of the table on which the object was last seen to stand.
    pub(crate) table: Option<TableHeight>,
    /// Number of frames as a duplicate of another track since their boxes overlap, less those as a
    /// thing of its own, but at least 0.
    pub(crate) n_frames_duplicate: u32,
    /// Occlusion state in the last frame, of a track without a candidate; `None` with one.
    pub(crate) unmatched: Option<OcclusionState>,
}

impl Track {
    /// Track of an object that has become certain in this frame; `reidentified_as` is the lost
    /// track that it looks like.
    pub(crate) fn start(
        id: u64,
        object: &ProspectiveObject,
        reidentified_as: Option<u64>,
        capture_ns: u64,
    ) -> Self {
        Self {
            id,
            first_seen_ns: object.first_seen_ns,
            last_seen_ns: capture_ns,
            measured: object.measured,
            n_views: 0,
            n_key_views: 0,
            reidentified_as,
            evidence: TrackEvidence::default(),
            lifecycle: TrackLifecycle::start(capture_ns),
            updated_filter: object.updated_filter,
            filter: object.filter,
            appearance: object.measured.appearance,
            last_handled_ns: 0,
            table: None,
            n_frames_duplicate: 0,
            unmatched: None,
        }
    }

    /// Recognition result of all sides that were seen.
    pub fn recognition(&self) -> &Recognition {
        self.evidence.recognition()
    }

    /// Visibility of the object in the last frame.
    pub fn visibility(&self) -> Visibility {
        self.lifecycle.visibility()
    }

    /// True for the track of an object that was seen in the last frame.
    pub(crate) fn is_visible(&self) -> bool {
        self.visibility() == Visibility::Visible
    }

    /// Predicted box at the capture stamp of the last frame, world frame.
    pub fn box_in_world(&self) -> OrientedBox {
        self.filter.box_in_world()
    }

    /// Velocity of the box centre, world frame, metres a second.
    pub fn velocity_m_s(&self) -> Vector3<f64> {
        self.filter.velocity_m_s()
    }

    /// Angular velocity, world frame, radians a second.
    pub fn angular_velocity_rad_s(&self) -> Vector3<f64> {
        self.filter.angular_velocity_rad_s()
    }

    /// Covariance of the box centre, world axes, square metres.
    pub fn position_covariance_m2(&self) -> Matrix3<f64> {
        self.filter.position_covariance_m2()
    }

    /// Covariance of a small rotation about the world axes, square radians.
    pub fn rotation_covariance_rad2(&self) -> Matrix3<f64> {
        self.filter.rotation_covariance_rad2()
    }

    /// Last motion state as the start of a prediction. An unseen object coasts only if a
    /// hand may be moving it: without a hand, what looked like motion was a camera pose that
    /// is wrong, an image border or another segmentation.
    pub(crate) fn state_to_predict(&self, now_ns: u64) -> MotionFilter {
        let may_be_moving = self.visibility() == Visibility::Visible
            || self.was_handled(now_ns, MOVED_AFTER_HANDLED_NS);
        if may_be_moving {
            self.updated_filter
        } else {
            self.updated_filter.stopped()
        }
    }

    /// True if a hand touched the object within a time before a capture stamp.
    pub(crate) fn was_handled(&self, now_ns: u64, within_ns: u64) -> bool {
        self.last_handled_ns > 0 && now_ns.saturating_sub(self.last_handled_ns) < within_ns
    }

    /// Updates the remembered appearance. A truncated or occluded view carries no size
    /// information, and its colours may belong to another object.
    pub(crate) fn remember(&mut self, appearance: &CoarseAppearance, is_whole: bool) {
        if self.appearance.is_truncated {
            // A smaller truncated view shows less of the object.
            if appearance.volume_m3 >= SIMILAR_VOLUME_RATIO_MIN * self.appearance.volume_m3 {
                self.appearance = *appearance;
            }
        } else if is_whole {
            let colors = &self.appearance.colors;
            self.appearance.colors = colors.blended(&appearance.colors, COLOR_LEARNING_RATE);
            self.appearance.volume_m3 = appearance.volume_m3;
        }
    }
}

/// Time after hand contact in which an object may still be moved, nanoseconds. Chosen.
pub(crate) const MOVED_AFTER_HANDLED_NS: u64 = 1_000_000_000;

/// Visible fraction of the box above which a view shows the whole object. Chosen.
pub(crate) const WHOLE_FRACTION_MIN: f64 = 0.9;

/// Volume ratio above which two boxes are about equally large. Chosen.
const SIMILAR_VOLUME_RATIO_MIN: f64 = 0.8;

/// Learning rate of the remembered colour histogram. Chosen.
const COLOR_LEARNING_RATE: f32 = 0.05;
