//! One object's view and cloud for outsiders.

use crate::near_category::{MAX_NEAR_CATEGORIES, NearCategory};
use crate::pose::WirePose;
use crate::{ActorStamps, SegmentLocation};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// One described view; the payload beside it is the descriptor, `f32` values.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ObjectViewHeader.v5")]
#[repr(C)]
pub struct ObjectViewHeader {
    /// The track.
    pub track_id: u64,
    /// Counts the views of the track, key views and others, from 0.
    pub view_id: u32,
    /// 1 when this is a key view: it goes to the perceptual memory.
    pub is_key_view: u32,
    /// Counts the messages of the port.
    pub sent: u64,
    /// Session of the camera.
    pub session: u64,
    /// Sequence of the frame.
    pub sequence: u64,
    /// Capture stamp of the frame.
    pub capture_ns: u64,
    /// When the view passed its actor.
    pub stamps: ActorStamps,
    /// Pose of the box's centre: `world_from_object`.
    pub pose: WirePose,
    /// Full lengths of the box's sides, metres.
    pub size_m: [f32; 3],
    /// Points of the view.
    pub n_points: u32,
    /// Where the actor read the frame's points: the camera's own bytes.
    pub frame_location: SegmentLocation,
    /// Index in the frame of the first point the actor read.
    pub first_point_index: u32,
    /// Dissimilarity to the nearest stored view; NaN when nothing is stored.
    pub distance: f32,
    /// Where detection read the frame's points.
    pub detection_location: SegmentLocation,
    /// Covariance of the position, as in [`SceneObject`](crate::SceneObject).
    pub position_covariance_m2: [f32; 6],
    /// Covariance of the orientation, as in [`SceneObject`](crate::SceneObject).
    pub rotation_covariance_rad2: [f32; 6],
    /// Velocity of the box's centre, world axes, metres a second.
    pub velocity_m_s: [f32; 3],
    /// Angular velocity, world axes, radians a second.
    pub angular_velocity_rad_s: [f32; 3],
    /// Key views of the track so far, this one included.
    pub n_key_views: u32,
    /// How many of `categories` are meant.
    pub n_categories: u32,
    /// The categories nearest to this view, nearest first.
    pub categories: [NearCategory; MAX_NEAR_CATEGORIES],
}

const _: () = assert!(size_of::<ObjectViewHeader>() == 824);

impl Default for ObjectViewHeader {
    fn default() -> Self {
        Self {
            track_id: 0,
            view_id: 0,
            is_key_view: 0,
            sent: 0,
            session: 0,
            sequence: 0,
            capture_ns: 0,
            stamps: ActorStamps::default(),
            pose: WirePose::default(),
            size_m: [0.0; 3],
            n_points: 0,
            frame_location: SegmentLocation::default(),
            first_point_index: 0,
            distance: f32::NAN,
            detection_location: SegmentLocation::default(),
            position_covariance_m2: [f32::NAN; 6],
            rotation_covariance_rad2: [f32::NAN; 6],
            velocity_m_s: [0.0; 3],
            angular_velocity_rad_s: [0.0; 3],
            n_key_views: 0,
            n_categories: 0,
            categories: [NearCategory::default(); MAX_NEAR_CATEGORIES],
        }
    }
}

impl ObjectViewHeader {
    /// The categories nearest to the view with their distances, nearest first.
    pub fn categories(&self) -> impl Iterator<Item = (&str, f32)> {
        NearCategory::meant(&self.categories, self.n_categories)
    }
}

/// The points of one object; the payload beside it is the points, camera frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ObjectCloudHeader.v1")]
#[repr(C)]
pub struct ObjectCloudHeader {
    /// The track.
    pub track_id: u64,
    /// Session of the camera.
    pub session: u64,
    /// Sequence of the frame.
    pub sequence: u64,
    /// Capture stamp of the frame.
    pub capture_ns: u64,
    /// Counts the messages of the port.
    pub sent: u64,
}

const _: () = assert!(size_of::<ObjectCloudHeader>() == 40);
