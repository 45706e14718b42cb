//! Scene summary: the tracked objects after one frame.

use crate::near_category::{MAX_NEAR_CATEGORIES, NearCategory};
use crate::pose::WirePose;
use crate::scene_time::SceneTime;
use crate::surface::{MAX_SURFACES, WireSurface};
use crate::{MAX_REJECTED_CANDIDATES, RejectedCandidate, SCHEMA_VERSION, Text, frame_flag};
use bytemuck::{AnyBitPattern, Zeroable};
use iceoryx2::prelude::ZeroCopySend;
use scene_document::CategoryAnswer;

/// Maximum number of objects in one scene summary.
pub const MAX_SCENE_OBJECTS: usize = 256;

/// Processing times of a frame by stage, monotonic clock, nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.StageStamps.v1")]
#[repr(C)]
pub struct StageStamps {
    /// Capture time of the light (see `FrameHeader::capture_stamp_ns`).
    pub capture_ns: u64,
    /// Scheduled publication time of the camera frame.
    pub scheduled_ns: u64,
    /// Publication time of the camera frame.
    pub camera_published_ns: u64,
    /// Time at which perception received the frame.
    pub received_ns: u64,
    /// Time at which detection of the frame finished.
    pub detected_ns: u64,
    /// Time at which the last actor answered or its deadline passed.
    pub recognised_ns: u64,
    /// Publication time of this scene summary.
    pub published_ns: u64,
}

/// Processing times of an object's newest view in its actor, monotonic clock, nanoseconds; 0
/// when not reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ActorStamps.v3")]
#[repr(C)]
pub struct ActorStamps {
    /// Time at which the view was sent to the actor.
    pub asked_ns: u64,
    /// Time at which the actor began to process the view.
    pub begun_ns: u64,
    /// Time at which the descriptor was complete.
    pub described_ns: u64,
    /// Time at which the recognition of the view was complete.
    pub recognised_ns: u64,
    /// Time at which the frame loop received the actor's answer.
    pub answered_ns: u64,
}

/// Tracked object of a scene summary.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.SceneObject.v6")]
#[repr(C)]
pub struct SceneObject {
    /// Track-id of the object; never reused.
    pub track_id: u64,
    /// State of the track: code of a [`TrackState`].
    pub state: u32,
    /// 1 when the image border cuts the object.
    pub cut_by_image: u32,
    /// Capture time of the first frame with this track, nanoseconds.
    pub first_seen_ns: u64,
    /// Capture time of the last frame with a measurement, nanoseconds.
    pub last_seen_ns: u64,
    /// Pose of the object's box: `world_from_object`.
    pub pose: WirePose,
    /// Side lengths of the object's box, metres.
    pub size_m: [f32; 3],
    /// Number of measured points of the object.
    pub n_points: u32,
    /// Number of described views of the object so far.
    pub n_views: u32,
    /// Mean colour of the object, packed as in `CloudPoint::argb`.
    pub mean_argb: u32,
    /// Shares of the basic colour terms, percent, in the order of
    /// [`ColorTerm::ALL`](point_cloud::ColorTerm::ALL); the rest is 0.
    pub color_percents: [u8; 16],
    /// Distance in descriptor space to the nearest stored view of the best category, mean over the
    /// sides; NaN when nothing is stored.
    pub distance: f32,
    /// 1 when `label` is a learned category, 0 when the object is unknown.
    pub is_labelled: u32,
    /// Category name; valid when `is_labelled` is 1.
    pub label: Text,
    /// Number of valid entries of `categories`.
    pub n_categories: u32,
    /// History sequence of the memory with which this label was recognised.
    pub memory_sequence: u64,
    /// Track-id of the lost track that this object continues (re-identification); 0 for none.
    pub linked_to: u64,
    /// Number of the newest view, from 0; valid when `n_views` is not 0.
    pub view_id: u32,
    /// 1 when this frame's view of the object is a key view.
    pub is_key_view: u32,
    /// Number of key views of the object so far.
    pub n_key_views: u32,
    /// Number of different sides of the object that the label rests on.
    pub n_sides: u32,
    /// Probability that the object belongs to the best category, 0 to 1; NaN when nothing is
    /// stored.
    pub probability: f32,
    /// Covariance of the position, packed: xx, xy, xz, yy, yz, zz, world axes, square metres.
    pub position_covariance_m2: [f32; 6],
    /// Covariance of a small rotation vector about the world's axes, packed: xx, xy, xz, yy, yz,
    /// zz, square radians.
    pub rotation_covariance_rad2: [f32; 6],
    /// Velocity of the box's centre, world axes, metres per second.
    pub velocity_m_s: [f32; 3],
    /// Angular velocity, world axes, radians per second.
    pub angular_velocity_rad_s: [f32; 3],
    /// Most probable categories, best first.
    pub categories: [NearCategory; MAX_NEAR_CATEGORIES],
    /// Processing times of the newest view in the object's actor.
    pub stamps: ActorStamps,
}

/// Scene summary after one frame. The payload is the tracked objects, by track-id.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.SceneSummary.v9")]
#[repr(C)]
pub struct SceneSummary {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Flags of the frame, see [`frame_flag`](crate::frame_flag).
    pub frame_flags: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
    /// Session number of the camera.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Number of frames of the session that perception dropped.
    pub frames_dropped: u64,
    /// Processing times of this frame's stages.
    pub stamps: StageStamps,
    /// Age above which the scene is stale, nanoseconds: a frame should have come by then.
    pub stale_after_ns: u64,
    /// Number of valid entries of `surfaces`.
    pub n_surfaces: u32,
    /// Number of objects; larger than the payload when they do not all fit.
    pub n_objects_total: u32,
    /// Number of object actors that missed their deadline; their objects were predicted.
    pub n_late: u32,
    /// Number of candidates of this frame that neither started nor continued a track; larger than
    /// `n_ignored` when they do not all fit.
    pub n_rejected: u32,
    /// Support surfaces, the table first.
    pub surfaces: [WireSurface; MAX_SURFACES],
    /// Pose of the camera, `world_from_camera`: the identity when it is not known, invalid
    /// before the first frame.
    pub world_from_camera: WirePose,
    /// Name of the camera or recording of the frame.
    pub source_name: Text,
    /// Bits of the [`Assumptions`](constraint::Assumptions) made for absent inputs.
    pub assumptions: u32,
    /// Rule by which a candidate starts a track, in the paper's notation.
    pub rule: Text,
    /// Number of valid entries of `ignored`.
    pub n_ignored: u32,
    /// Rejected candidates, nearest to the camera first.
    pub ignored: [RejectedCandidate; MAX_REJECTED_CANDIDATES],
}

const _: () = assert!(
    size_of::<StageStamps>() == 56
        && size_of::<ActorStamps>() == 40
        && size_of::<SceneObject>() == 984
);
const _: () = assert!(
    size_of::<SceneSummary>()
        == 312 + 136 + MAX_REJECTED_CANDIDATES * 184 + MAX_SURFACES * size_of::<WireSurface>()
);

impl Default for SceneObject {
    fn default() -> Self {
        Self {
            distance: f32::NAN,
            probability: f32::NAN,
            position_covariance_m2: [f32::NAN; 6],
            rotation_covariance_rad2: [f32::NAN; 6],
            categories: [NearCategory::default(); MAX_NEAR_CATEGORIES],
            ..Self::zeroed()
        }
    }
}

impl Default for SceneSummary {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            ..Self::zeroed()
        }
    }
}

impl SceneSummary {
    /// Times by which the age of the scene is measured.
    pub fn time(&self) -> SceneTime {
        SceneTime {
            capture_ns: self.stamps.capture_ns,
            received_ns: self.stamps.received_ns,
            stale_after_ns: self.stale_after_ns,
            is_lockstep: self.frame_flags & frame_flag::LOCKSTEP != 0,
        }
    }

    /// Support surfaces of the summary, the table first; those of no known kind are not valid.
    pub fn surfaces(&self) -> &[WireSurface] {
        &self.surfaces[..MAX_SURFACES.min(self.n_surfaces as usize)]
    }

    /// Table: the surface on which objects are looked for first; `None` when none was found.
    pub fn table(&self) -> Option<&WireSurface> {
        let table = self.surfaces().first();
        table.filter(|table| table.checked_kind().is_some())
    }

    /// Rejected candidates of the summary.
    pub fn rejected_candidates(&self) -> &[RejectedCandidate] {
        &self.ignored[..MAX_REJECTED_CANDIDATES.min(self.n_ignored as usize)]
    }
}

impl SceneObject {
    /// Category name; `None` for an unknown object.
    pub fn label(&self) -> Option<&str> {
        if self.is_labelled == 1 {
            self.label.as_str()
        } else {
            None
        }
    }

    /// Answer about the category: certain, probable or unknown.
    pub fn answer(&self) -> CategoryAnswer {
        let probability = f64::from(self.probability);
        let is_told = probability.is_finite();
        CategoryAnswer::of(self.label().is_some(), is_told.then_some(probability))
    }

    /// Number of the newest view; `None` before the first view.
    pub fn view(&self) -> Option<u32> {
        (self.n_views > 0).then_some(self.view_id)
    }

    /// Track-id of the lost track that this object continues, if any.
    pub fn linked_to(&self) -> Option<u64> {
        (self.linked_to != 0).then_some(self.linked_to)
    }

    /// Most probable categories with distance and probability, best first. Invalid entries are
    /// skipped.
    pub fn categories(&self) -> impl Iterator<Item = (&str, f32, f32)> {
        NearCategory::valid_entries(&self.categories, self.n_categories)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_no_view_before_the_first() {
        let mut object = SceneObject::default();
        assert_eq!((object.view(), object.linked_to()), (None, None));
        (object.n_views, object.view_id, object.linked_to) = (4, 3, 9);
        assert_eq!((object.view(), object.linked_to()), (Some(3), Some(9)));
    }

    #[test]
    fn a_hostile_number_of_rejected_candidates_is_clamped() {
        let summary = SceneSummary {
            n_ignored: u32::MAX,
            ..SceneSummary::default()
        };
        assert_eq!(summary.rejected_candidates().len(), MAX_REJECTED_CANDIDATES);
    }
}
