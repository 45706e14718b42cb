//! One object's view and cloud for outsiders.

use crate::SegmentLocation;
use crate::pose::WirePose;
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// One described view; the payload beside it is the descriptor, `f32` values.
#[derive(Debug, Clone, Copy, PartialEq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ObjectViewHeader.v1")]
#[repr(C)]
pub struct ObjectViewHeader {
    /// The track.
    pub track_id: u64,
    /// Counts the views of the track, key views and others, from 0.
    pub view_id: u32,
    /// 1 when this is a key view: it goes to the perceptual memory.
    pub is_key_view: u32,
    /// Session of the camera.
    pub session: u64,
    /// Sequence of the frame.
    pub sequence: u64,
    /// Capture stamp of the frame.
    pub capture_ns: u64,
    /// When the actor had finished this view, monotonic.
    pub described_ns: u64,
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
    /// Counts the messages of the port.
    pub sent: u64,
}

const _: () = assert!(size_of::<ObjectViewHeader>() == 168);

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
