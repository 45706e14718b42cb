//! Topics of a single object: described view and point cloud.

use crate::near_category::{MAX_NEAR_CATEGORIES, NearCategory};
use crate::pose::WirePose;
use crate::{ActorStamps, SegmentLocation};
use bytemuck::{AnyBitPattern, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// Header of one described view of an object. The payload is the descriptor, `f32` values.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ObjectViewHeader.v6")]
#[repr(C)]
pub struct ObjectViewHeader {
    /// Track-id of the object.
    pub track_id: u64,
    /// Number of the view within the track, key views and others, from 0.
    pub view_id: u32,
    /// 1 when this is a key view, which goes to the perceptual memory.
    pub is_key_view: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
    /// Session number of the camera.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Capture time of the frame, nanoseconds.
    pub capture_ns: u64,
    /// Processing times of the view in its actor.
    pub stamps: ActorStamps,
    /// Pose of the object's box: `world_from_object`.
    pub pose: WirePose,
    /// Side lengths of the object's box, metres.
    pub size_m: [f32; 3],
    /// Number of points of the object's view.
    pub n_points: u32,
    /// Shared memory location from which the actor read the frame's points: the camera's own bytes.
    pub frame_location: SegmentLocation,
    /// Index in the frame of the first point that the actor read.
    pub first_point_index: u32,
    /// Distance in descriptor space to the nearest stored view of the best category, mean over the
    /// sides; NaN when nothing is stored.
    pub distance: f32,
    /// Shared memory location from which detection read the frame's points.
    pub detection_location: SegmentLocation,
    /// Covariance of the position, as in [`SceneObject`](crate::SceneObject).
    pub position_covariance_m2: [f32; 6],
    /// Covariance of the orientation, as in [`SceneObject`](crate::SceneObject).
    pub rotation_covariance_rad2: [f32; 6],
    /// Velocity of the box's centre, world axes, metres per second.
    pub velocity_m_s: [f32; 3],
    /// Angular velocity, world axes, radians per second.
    pub angular_velocity_rad_s: [f32; 3],
    /// Number of key views of the track so far, including this one.
    pub n_key_views: u32,
    /// Number of valid entries of `categories`.
    pub n_categories: u32,
    /// Most probable categories, best first.
    pub categories: [NearCategory; MAX_NEAR_CATEGORIES],
}

const _: () = assert!(size_of::<ObjectViewHeader>() == 840);

impl Default for ObjectViewHeader {
    fn default() -> Self {
        Self {
            distance: f32::NAN,
            position_covariance_m2: [f32::NAN; 6],
            rotation_covariance_rad2: [f32::NAN; 6],
            categories: [NearCategory::default(); MAX_NEAR_CATEGORIES],
            ..Self::zeroed()
        }
    }
}

impl ObjectViewHeader {
    /// Most probable categories with distance and probability, best first.
    pub fn categories(&self) -> impl Iterator<Item = (&str, f32, f32)> {
        NearCategory::valid_entries(&self.categories, self.n_categories)
    }
}

/// Header of the point cloud of one object. The payload is the points, camera frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ObjectCloudHeader.v1")]
#[repr(C)]
pub struct ObjectCloudHeader {
    /// Track-id of the object.
    pub track_id: u64,
    /// Session number of the camera.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Capture time of the frame, nanoseconds.
    pub capture_ns: u64,
    /// Message number of the port, from 1.
    pub sent: u64,
}

const _: () = assert!(size_of::<ObjectCloudHeader>() == 40);
