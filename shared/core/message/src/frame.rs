//! Camera frame: header and points.

use crate::pose::WireTransform;
use crate::{SCHEMA_VERSION, Text};
use bytemuck::{AnyBitPattern, Pod, Zeroable};
use geometry::{InvalidIntrinsics, PinholeCamera, RigidTransform};
use iceoryx2::prelude::ZeroCopySend;
use nalgebra::{Unit, Vector3};
use std::mem::offset_of;

/// Point in shared memory; same layout as [`point_cloud::Point`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.CloudPoint.v1")]
#[repr(C)]
pub struct CloudPoint {
    /// Right coordinate in the camera frame, metres; NaN without depth.
    pub x: f32,
    /// Down coordinate in the camera frame, metres.
    pub y: f32,
    /// Forward coordinate in the camera frame, metres.
    pub z: f32,
    /// Packed colour: alpha, red, green, blue from the highest byte to the lowest.
    pub argb: u32,
}

const _: () = assert!(size_of::<CloudPoint>() == 16 && align_of::<CloudPoint>() == 4);

/// Zero-copy view of a message's points as [`point_cloud::Point`]s.
pub fn points(cloud: &[CloudPoint]) -> &[point_cloud::Point] {
    bytemuck::cast_slice(cloud)
}

/// Zero-copy mutable view of a message's points as [`point_cloud::Point`]s.
pub fn points_mut(cloud: &mut [CloudPoint]) -> &mut [point_cloud::Point] {
    bytemuck::cast_slice_mut(cloud)
}

/// Bits of [`FrameHeader::flags`].
pub mod frame_flag {
    /// Lockstep: the source waits for [`FrameDone`](crate::FrameDone) of every follower.
    pub const LOCKSTEP: u32 = 1;
    /// `world_from_camera` is valid; otherwise the world frame is the camera frame.
    pub const HAS_WORLD_POSE: u32 = 1 << 1;
    /// Flag: the field `up_in_camera` is valid.
    pub const HAS_UP: u32 = 1 << 2;
    /// Intrinsics are calibrated for this camera; otherwise nominal.
    pub const CALIBRATED: u32 = 1 << 3;
}

/// Location of bytes in a shared memory segment, equal in every process that maps it. Inode 0:
/// unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.SegmentLocation.v1")]
#[repr(C)]
pub struct SegmentLocation {
    /// Inode of the shared-memory segment's file.
    pub inode: u64,
    /// Offset of the payload's first byte in the shared-memory segment.
    pub offset_bytes: u64,
}

/// Longest time by which a capture stamp may be ahead of the reception, nanoseconds. Both are of
/// the monotonic clock, so it is room for a source that predicts the exposure. Chosen.
const STAMP_AHEAD_MAX_NS: u64 = 1_000_000_000;

/// Header of a camera frame. Its first cache line holds the fields that a receiver reads of
/// every frame.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.FrameHeader.v5")]
#[repr(C)]
#[repr(align(64))]
pub struct FrameHeader {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Flags of the frame: bits of [`frame_flag`].
    pub flags: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
    /// Random id of this run of the source. Sequence numbers of different sessions cannot be
    /// compared.
    pub session: u64,
    /// Sequence number of the frame within the session, from 0, without gaps.
    pub sequence: u64,
    /// Number of the frame in its recording; equals `sequence` for a live camera.
    pub source_frame: u64,
    /// Capture time of the light, nanoseconds: monotonic clock, or the source's own clock in
    /// lockstep.
    pub capture_stamp_ns: u64,
    /// Scheduled publication time at the source's rate, monotonic clock, nanoseconds.
    pub scheduled_stamp_ns: u64,
    /// Publication time of the frame, monotonic clock, nanoseconds.
    pub published_stamp_ns: u64,
    /// Offset from the monotonic clock to the wall clock (wall minus monotonic), nanoseconds.
    pub wall_clock_offset_ns: i64,
    /// Focal lengths and principal point: fx, fy, cx, cy.
    pub intrinsics_px: [f64; 4],
    /// Width and height of the cloud, points.
    pub size_px: [u32; 2],
    /// Pose of the camera; valid with `HAS_WORLD_POSE`.
    pub world_from_camera: WireTransform,
    /// Up direction (against gravity) in the camera frame, unit length; valid with `HAS_UP`.
    pub up_in_camera: [f64; 3],
    /// Shared memory location of the points, as written by the camera.
    pub location: SegmentLocation,
    /// Name of the camera or recording.
    pub source_name: Text,
    /// Padding for alignment, zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<FrameHeader>() == 384 && align_of::<FrameHeader>() == 64);
const _: () = assert!(offset_of!(FrameHeader, published_stamp_ns) < 64);

/// Acknowledgement of a follower of a lockstep source: the frame is processed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.FrameDone.v1")]
#[repr(C)]
pub struct FrameDone {
    /// Session number of the frame source.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Process that finished the frame: code of a [`ProcessKind`](crate::ProcessKind).
    pub process: u64,
}

const _: () = assert!(size_of::<FrameDone>() == 24);

/// Validated content of a frame header.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedFrame {
    /// Camera intrinsics with the image size.
    pub camera: PinholeCamera,
    /// Pose of the camera; `None` when unknown.
    pub world_from_camera: Option<RigidTransform>,
    /// Up direction (against gravity) in the camera frame; `None` when unknown.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
}

/// Error of checking a received frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidFrame {
    /// Schema version of another build of tabula.
    #[error(
        "the frame has schema version {0}, this process reads {own}; \
         stop all tabula processes of this domain and start them from one build",
        own = SCHEMA_VERSION
    )]
    SchemaVersion(u32),
    /// Impossible camera intrinsics in the frame header.
    #[error("{0}")]
    Intrinsics(InvalidIntrinsics),
    /// Number of points that does not fill the image.
    #[error(
        "the frame holds {n_points} points, its header says {}x{}",
        .size_px[0], .size_px[1]
    )]
    Size {
        /// Number of points in the message.
        n_points: usize,
        /// Width and height according to the frame header, pixels.
        size_px: [u32; 2],
    },
    /// Capture time in the future.
    #[error("the frame's capture time is {ahead_s:.0} s in the future")]
    CaptureStamp {
        /// Time from the reception of the frame to its capture time, seconds.
        ahead_s: f64,
    },
    /// Camera pose `world_from_camera` that is no rigid transform.
    #[error("the frame's camera pose is not a rigid transform")]
    WorldPose,
    /// Up direction `up_in_camera` that is no unit vector.
    #[error("the frame's direction against gravity is not a direction")]
    Up,
}

impl Default for FrameHeader {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            world_from_camera: WireTransform::IDENTITY,
            ..Self::zeroed()
        }
    }
}

impl FrameHeader {
    /// True if a flag of [`frame_flag`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Sets the camera intrinsics and the image size.
    pub fn set_camera(&mut self, camera: &PinholeCamera) {
        (self.intrinsics_px, self.size_px) = intrinsics_of(camera);
    }

    /// Validates the header against its own fields, the number of points and the time at which
    /// it was received (monotonic clock, nanoseconds).
    ///
    /// # Errors
    /// Says which number is impossible.
    pub fn checked(&self, n_points: usize, received_ns: u64) -> Result<CheckedFrame, InvalidFrame> {
        if self.schema_version != SCHEMA_VERSION {
            return Err(InvalidFrame::SchemaVersion(self.schema_version));
        }
        self.check_capture_stamp(received_ns)?;
        let camera = PinholeCamera::with_intrinsics(self.intrinsics_px, self.size_px)
            .map_err(InvalidFrame::Intrinsics)?;
        if camera.n_pixels() != n_points {
            return Err(InvalidFrame::Size {
                n_points,
                size_px: self.size_px,
            });
        }
        Ok(CheckedFrame {
            camera,
            world_from_camera: self.checked_world_pose()?,
            up_in_camera: self.checked_up()?,
        })
    }

    /// The clock of a recording in lockstep is its own; its stamps only have to be numbers that
    /// can be calculated with.
    fn check_capture_stamp(&self, received_ns: u64) -> Result<(), InvalidFrame> {
        let latest_ns = if self.has(frame_flag::LOCKSTEP) {
            i64::MAX.cast_unsigned()
        } else {
            received_ns.saturating_add(STAMP_AHEAD_MAX_NS)
        };
        if self.capture_stamp_ns > latest_ns {
            return Err(InvalidFrame::CaptureStamp {
                ahead_s: (self.capture_stamp_ns - received_ns.min(latest_ns)) as f64 * 1e-9,
            });
        }
        Ok(())
    }

    fn checked_world_pose(&self) -> Result<Option<RigidTransform>, InvalidFrame> {
        if !self.has(frame_flag::HAS_WORLD_POSE) {
            return Ok(None);
        }
        self.world_from_camera
            .checked()
            .map(Some)
            .ok_or(InvalidFrame::WorldPose)
    }

    fn checked_up(&self) -> Result<Option<Unit<Vector3<f64>>>, InvalidFrame> {
        if !self.has(frame_flag::HAS_UP) {
            return Ok(None);
        }
        checked_direction(self.up_in_camera)
            .map(Some)
            .ok_or(InvalidFrame::Up)
    }
}

/// Intrinsics fx, fy, cx, cy and size of a camera, pixels, as headers have them.
pub(crate) fn intrinsics_of(camera: &PinholeCamera) -> ([f64; 4], [u32; 2]) {
    (
        [camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px],
        [camera.width, camera.height],
    )
}

fn checked_direction(direction: [f64; 3]) -> Option<Unit<Vector3<f64>>> {
    let direction = Vector3::from(direction);
    let length = direction.norm();
    (length.is_finite() && (length - 1.0).abs() < 1e-3).then(|| Unit::new_normalize(direction))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECEIVED_NS: u64 = 1_000_000_000_000;

    fn good() -> FrameHeader {
        let mut header = FrameHeader {
            up_in_camera: [0.0, -1.0, 0.0],
            ..FrameHeader::default()
        };
        header.set_camera(&PinholeCamera::KINECT_V1);
        header.flags = frame_flag::HAS_UP | frame_flag::HAS_WORLD_POSE;
        header
    }

    #[test]
    fn a_good_header_passes() {
        let frame = good().checked(640 * 480, 0).unwrap();
        assert_eq!(frame.camera, PinholeCamera::KINECT_V1);
        assert_eq!(frame.world_from_camera, Some(RigidTransform::identity()));
    }

    #[test]
    fn each_impossible_number_is_named() {
        let check = |change: &dyn Fn(&mut FrameHeader), n_points: usize, word: &str| {
            let mut header = good();
            change(&mut header);
            let sentence = header
                .checked(n_points, RECEIVED_NS)
                .unwrap_err()
                .to_string();
            assert!(sentence.contains(word), "{sentence}");
        };
        let full = 640 * 480;
        check(&|h| h.schema_version = 99, full, "version 99");
        check(&|h| h.intrinsics_px[0] = f64::NAN, full, "intrinsics");
        check(&|h| h.size_px = [u32::MAX, u32::MAX], full, "intrinsics");
        check(&|_| (), full - 1, "points");
        check(&|h| h.world_from_camera.rows[0][0] = 5.0, full, "rigid");
        check(&|h| h.up_in_camera = [0.0; 3], full, "gravity");
        let too_late_ns = RECEIVED_NS + STAMP_AHEAD_MAX_NS + 1;
        check(&|h| h.capture_stamp_ns = too_late_ns, full, "future");
        let without_end = |h: &mut FrameHeader| {
            h.flags |= frame_flag::LOCKSTEP;
            h.capture_stamp_ns = u64::MAX;
        };
        check(&without_end, full, "future");
    }

    #[test]
    fn stamps_of_a_recording_in_lockstep_are_its_own() {
        let mut header = good();
        header.capture_stamp_ns = 1_700_000_000_000_000_000;
        assert!(header.checked(640 * 480, RECEIVED_NS).is_err());
        header.flags |= frame_flag::LOCKSTEP;
        assert!(header.checked(640 * 480, RECEIVED_NS).is_ok());
    }

    #[test]
    fn the_wire_point_is_the_kernels_point() {
        let wire = [CloudPoint {
            x: 1.0,
            y: 2.0,
            z: 3.0,
            argb: 0xff01_0203,
        }];
        let point = points(&wire)[0];
        assert_eq!(
            (point.x, point.y, point.z, point.color.rgb()),
            (1.0, 2.0, 3.0, [1, 2, 3])
        );
    }
}
