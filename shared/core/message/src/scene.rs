//! The live world model.

use crate::near_category::{MAX_NEAR_CATEGORIES, NearCategory};
use crate::pose::WirePose;
use crate::{IgnoredBlob, MAX_IGNORED, SCHEMA_VERSION, Text};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Most objects in one summary.
pub const MAX_SCENE_OBJECTS: usize = 256;

/// The state of a track, as a number in [`SceneObject::state`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackState {
    /// Seen too briefly to be believed.
    Tentative,
    /// Seen in this frame.
    Tracked,
    /// Not seen in this frame, expected to come back.
    Missing,
    /// Not seen in this frame, for something stands before its place.
    Occluded,
    /// Not seen in this frame, for its place is not in the image.
    OutOfView,
}

impl TrackState {
    const ALL: [Self; 5] = [
        Self::Tentative,
        Self::Tracked,
        Self::Missing,
        Self::Occluded,
        Self::OutOfView,
    ];

    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The state of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|state| state.code() == code)
    }

    /// The word for people and scripts.
    pub fn word(self) -> &'static str {
        match self {
            Self::Tentative => "tentative",
            Self::Tracked => "tracked",
            Self::Missing => "missing",
            Self::Occluded => "occluded",
            Self::OutOfView => "out-of-view",
        }
    }
}

/// When a frame passed the stages, monotonic clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.StageStamps.v1")]
#[repr(C)]
pub struct StageStamps {
    /// When the light was captured (see `FrameHeader::capture_stamp_ns`).
    pub capture_ns: u64,
    /// When the camera should have published.
    pub scheduled_ns: u64,
    /// When the camera published.
    pub camera_published_ns: u64,
    /// When perception took the frame.
    pub received_ns: u64,
    /// When detection had finished.
    pub detected_ns: u64,
    /// When the last actor had answered or its time was over.
    pub recognised_ns: u64,
    /// When this summary was published.
    pub published_ns: u64,
}

/// When one object's newest view passed its actor, monotonic clock; 0 where it has
/// not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ActorStamps.v3")]
#[repr(C)]
pub struct ActorStamps {
    /// When the view was handed to the actor.
    pub asked_ns: u64,
    /// When the actor began it.
    pub begun_ns: u64,
    /// When it was described.
    pub described_ns: u64,
    /// When it was compared with what was taught.
    pub recognised_ns: u64,
    /// When the frame loop had the answer.
    pub answered_ns: u64,
}

/// One object of the summary.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.SceneObject.v4")]
#[repr(C)]
pub struct SceneObject {
    /// The track-id; never used twice.
    pub track_id: u64,
    /// Number of a [`TrackState`].
    pub state: u32,
    /// 1 when the image border cuts the object.
    pub cut_by_image: u32,
    /// Capture stamp of the first frame with this track.
    pub first_seen_ns: u64,
    /// Capture stamp of the last frame with a measurement.
    pub last_seen_ns: u64,
    /// Pose of the box's centre: `world_from_object`.
    pub pose: WirePose,
    /// Full lengths of the box's sides, metres.
    pub size_m: [f32; 3],
    /// Measured points.
    pub n_points: u32,
    /// Views described so far.
    pub n_views: u32,
    /// Mean colour, packed as in `CloudPoint::argb`.
    pub mean_argb: u32,
    /// Dissimilarity to the nearest stored view; NaN when nothing is stored.
    pub distance: f32,
    /// 1 when `label` is a learned category, 0 when the object is unknown.
    pub is_labelled: u32,
    /// The category, when labelled.
    pub label: Text,
    /// How many of `categories` are meant.
    pub n_categories: u32,
    /// History sequence of the memory this label was made with.
    pub memory_sequence: u64,
    /// The lost track this object is taken to continue; 0 for none.
    pub linked_to: u64,
    /// Number of the newest view, from 0; meant when `n_views` is not 0.
    pub view_id: u32,
    /// 1 when this frame's view of the object is a key view.
    pub is_key_view: u32,
    /// Key views so far.
    pub n_key_views: u32,
    /// Probability that the object belongs to the nearest category, 0 to 1; NaN when
    /// nothing is stored.
    pub probability: f32,
    /// Covariance of the position: xx, xy, xz, yy, yz, zz, world axes, square metres.
    pub position_covariance_m2: [f32; 6],
    /// Covariance of a small rotation vector about the world's axes: xx, xy, xz, yy,
    /// yz, zz, square radians.
    pub rotation_covariance_rad2: [f32; 6],
    /// Velocity of the box's centre, world axes, metres a second.
    pub velocity_m_s: [f32; 3],
    /// Angular velocity, world axes, radians a second.
    pub angular_velocity_rad_s: [f32; 3],
    /// The nearest categories, nearest first.
    pub categories: [NearCategory; MAX_NEAR_CATEGORIES],
    /// When the newest view passed the object's actor.
    pub stamps: ActorStamps,
}

/// The world after one frame; the payload beside it is the objects, by track-id.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.SceneSummary.v5")]
#[repr(C)]
pub struct SceneSummary {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Flags of the frame, see [`frame_flag`](crate::frame_flag).
    pub frame_flags: u32,
    /// Counts the messages of the port.
    pub sent: u64,
    /// Session of the camera.
    pub session: u64,
    /// Sequence of the frame.
    pub sequence: u64,
    /// Frames of the session that perception has not processed.
    pub frames_dropped: u64,
    /// Stamps of this frame.
    pub stamps: StageStamps,
    /// 1 when a table was found.
    pub has_table: u32,
    /// How many objects there are; more than come with the summary when they do not fit.
    pub n_objects_total: u32,
    /// Object actors that had not answered in time and were predicted.
    pub n_late: u32,
    /// Candidates of this frame that started no track and continued none; more
    /// than `ignored` holds when they do not fit.
    pub n_rejected: u32,
    /// The table's plane in the world: normal and offset, metres.
    pub table_plane: [f64; 4],
    /// Name of the source or file of the frame.
    pub source_name: Text,
    /// Bits of the [`Assumptions`](constraint::Assumptions) the frame was judged with.
    pub assumptions: u32,
    /// The rule by which a candidate begins a track, in the paper's notation.
    pub rule: Text,
    /// How many of `ignored` are meant.
    pub n_ignored: u32,
    /// Candidates that started no track and continued none, nearest first.
    pub ignored: [IgnoredBlob; MAX_IGNORED],
}

const _: () = assert!(
    size_of::<StageStamps>() == 56
        && size_of::<ActorStamps>() == 40
        && size_of::<SceneObject>() == 944
);
const _: () = assert!(size_of::<SceneSummary>() == 280 + 136 + MAX_IGNORED * 176);

impl Default for SceneObject {
    fn default() -> Self {
        Self {
            track_id: 0,
            state: 0,
            cut_by_image: 0,
            first_seen_ns: 0,
            last_seen_ns: 0,
            pose: WirePose::default(),
            size_m: [0.0; 3],
            n_points: 0,
            n_views: 0,
            mean_argb: 0,
            distance: f32::NAN,
            is_labelled: 0,
            label: Text::default(),
            n_categories: 0,
            memory_sequence: 0,
            linked_to: 0,
            view_id: 0,
            is_key_view: 0,
            n_key_views: 0,
            probability: f32::NAN,
            position_covariance_m2: [f32::NAN; 6],
            rotation_covariance_rad2: [f32::NAN; 6],
            velocity_m_s: [0.0; 3],
            angular_velocity_rad_s: [0.0; 3],
            categories: [NearCategory::default(); MAX_NEAR_CATEGORIES],
            stamps: ActorStamps::default(),
        }
    }
}

impl Default for SceneSummary {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            frame_flags: 0,
            sent: 0,
            session: 0,
            sequence: 0,
            frames_dropped: 0,
            stamps: StageStamps::default(),
            has_table: 0,
            n_objects_total: 0,
            n_late: 0,
            n_rejected: 0,
            table_plane: [0.0; 4],
            source_name: Text::default(),
            assumptions: 0,
            rule: Text::default(),
            n_ignored: 0,
            ignored: [IgnoredBlob::default(); MAX_IGNORED],
        }
    }
}

impl SceneSummary {
    /// The ignored candidates that came with the summary.
    pub fn ignored(&self) -> &[IgnoredBlob] {
        &self.ignored[..MAX_IGNORED.min(self.n_ignored as usize)]
    }
}

impl SceneObject {
    /// The learned category; `None` for an unknown object.
    pub fn label(&self) -> Option<&str> {
        if self.is_labelled == 1 {
            self.label.as_str()
        } else {
            None
        }
    }

    /// Number of the newest view; `None` before the first.
    pub fn view(&self) -> Option<u32> {
        (self.n_views > 0).then_some(self.view_id)
    }

    /// The track this object is taken to continue.
    pub fn linked_to(&self) -> Option<u64> {
        (self.linked_to != 0).then_some(self.linked_to)
    }

    /// The nearest categories with their distances, nearest first. What is no name
    /// or no distance is left out.
    pub fn categories(&self) -> impl Iterator<Item = (&str, f32)> {
        NearCategory::meant(&self.categories, self.n_categories)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_survive_the_border_and_others_are_none() {
        for state in TrackState::ALL {
            assert_eq!(TrackState::from_code(state.code()), Some(state));
        }
        assert_eq!(TrackState::from_code(77), None);
        let words = TrackState::ALL.map(TrackState::word);
        assert!(words.contains(&"occluded") && words.contains(&"out-of-view"));
    }

    #[test]
    fn before_the_first_view_there_is_none() {
        let mut object = SceneObject::default();
        assert_eq!((object.view(), object.linked_to()), (None, None));
        (object.n_views, object.view_id, object.linked_to) = (4, 3, 9);
        assert_eq!((object.view(), object.linked_to()), (Some(3), Some(9)));
    }

    #[test]
    fn a_hostile_number_of_ignored_ones_is_cut() {
        let summary = SceneSummary {
            n_ignored: u32::MAX,
            ..SceneSummary::default()
        };
        assert_eq!(summary.ignored().len(), MAX_IGNORED);
    }
}
