//! One frame of the camera: header and points.

use crate::pose::WireTransform;
use crate::{SCHEMA_VERSION, Text};
use bytemuck::{AnyBitPattern, Pod, Zeroable};
use geometry::{InvalidIntrinsics, PinholeCamera, RigidTransform};
use iceoryx2::prelude::ZeroCopySend;
use nalgebra::{Unit, Vector3};
use std::fmt;
use std::mem::offset_of;

/// A point in shared memory; the same bytes as [`point_cloud::Point`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.CloudPoint.v1")]
#[repr(C)]
pub struct CloudPoint {
    /// Right, metres; NaN without depth.
    pub x: f32,
    /// Down, metres.
    pub y: f32,
    /// Forward, metres.
    pub z: f32,
    /// Alpha, red, green, blue from the highest byte to the lowest.
    pub argb: u32,
}

const _: () = assert!(size_of::<CloudPoint>() == 16 && align_of::<CloudPoint>() == 4);

/// Points of a message as the kernels' type, without a copy.
pub fn points(cloud: &[CloudPoint]) -> &[point_cloud::Point] {
    bytemuck::cast_slice(cloud)
}

/// Points of a message to be filled by the kernels, without a copy.
pub fn points_mut(cloud: &mut [CloudPoint]) -> &mut [point_cloud::Point] {
    bytemuck::cast_slice_mut(cloud)
}

/// Bits of [`FrameHeader::flags`].
pub mod frame_flag {
    /// The source waits for the followers' [`FrameDone`](crate::FrameDone).
    pub const LOCKSTEP: u32 = 1;
    /// `world_from_camera` is known; without it world = camera.
    pub const HAS_WORLD_POSE: u32 = 1 << 1;
    /// `up_in_camera` is known.
    pub const HAS_UP: u32 = 1 << 2;
    /// The intrinsics were measured for this camera, not taken as nominal.
    pub const CALIBRATED: u32 = 1 << 3;
}

/// Where bytes lie in a shared memory segment, the same for every process that
/// maps it. Zero inode: not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.SegmentLocation.v1")]
#[repr(C)]
pub struct SegmentLocation {
    /// Inode of the segment's file.
    pub inode: u64,
    /// Offset of the first byte in the segment.
    pub offset_bytes: u64,
}

/// What the camera says about a frame. Its first cache line holds what a receiver
/// reads of every frame.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.FrameHeader.v5")]
#[repr(C)]
#[repr(align(64))]
pub struct FrameHeader {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Bits of [`frame_flag`].
    pub flags: u32,
    /// Counts the messages of the port.
    pub sent: u64,
    /// Random number of this run of the source: sequences of different sessions
    /// do not compare.
    pub session: u64,
    /// Counts the frames of the session, from 0, without gaps.
    pub sequence: u64,
    /// Number of the frame in its recording; equals `sequence` for a live camera.
    pub source_frame: u64,
    /// When the light was captured: monotonic clock, or the source's own clock in lockstep.
    pub capture_stamp_ns: u64,
    /// When the frame should have been published at the source's rate, monotonic.
    pub scheduled_stamp_ns: u64,
    /// When it was published, monotonic.
    pub published_stamp_ns: u64,
    /// Wall clock minus monotonic clock.
    pub wall_clock_offset_ns: i64,
    /// Focal lengths and principal point: fx, fy, cx, cy.
    pub intrinsics_px: [f64; 4],
    /// Columns and rows of the cloud.
    pub size_px: [u32; 2],
    /// Pose of the camera; meaningful with `HAS_WORLD_POSE`.
    pub world_from_camera: WireTransform,
    /// Direction against gravity in the camera's frame; meaningful with `HAS_UP`.
    pub up_in_camera: [f64; 3],
    /// Where the camera wrote the points.
    pub location: SegmentLocation,
    /// Name of the source or file.
    pub source_name: Text,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<FrameHeader>() == 384 && align_of::<FrameHeader>() == 64);
const _: () = assert!(offset_of!(FrameHeader, published_stamp_ns) < 64);

/// A follower of a lockstep source has finished a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.FrameDone.v1")]
#[repr(C)]
pub struct FrameDone {
    /// Session of the source.
    pub session: u64,
    /// The frame.
    pub sequence: u64,
    /// Who: a [`ProcessKind`](crate::ProcessKind) as a number.
    pub process: u64,
}

const _: () = assert!(size_of::<FrameDone>() == 24);

/// A header whose numbers have been checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedFrame {
    /// Intrinsics and size.
    pub camera: PinholeCamera,
    /// Pose of the camera; `None` when unknown.
    pub world_from_camera: Option<RigidTransform>,
    /// Direction against gravity; `None` when unknown.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
}

/// Why a received frame can not be used.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum InvalidFrame {
    /// Written by another version of tabula.
    SchemaVersion(u32),
    /// The intrinsics are impossible.
    Intrinsics(InvalidIntrinsics),
    /// The number of points is not that of the grid.
    Size {
        /// Points in the message.
        n_points: usize,
        /// Columns and rows of the header.
        size_px: [u32; 2],
    },
    /// `world_from_camera` is no rigid transform.
    WorldPose,
    /// `up_in_camera` is no direction.
    Up,
}

impl fmt::Display for InvalidFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SchemaVersion(version) => write!(
                f,
                "the frame has schema version {version}, this process reads {SCHEMA_VERSION}; \
                 stop all tabula processes of this domain and start them from one build"
            ),
            Self::Intrinsics(error) => write!(f, "{error}"),
            Self::Size {
                n_points,
                size_px: [width, height],
            } => {
                write!(
                    f,
                    "the frame holds {n_points} points, its header says {width}x{height}"
                )
            }
            Self::WorldPose => f.write_str("the frame's camera pose is not a rigid transform"),
            Self::Up => f.write_str("the frame's direction against gravity is not a direction"),
        }
    }
}

impl std::error::Error for InvalidFrame {}

impl Default for FrameHeader {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            flags: 0,
            sent: 0,
            session: 0,
            sequence: 0,
            source_frame: 0,
            capture_stamp_ns: 0,
            scheduled_stamp_ns: 0,
            published_stamp_ns: 0,
            wall_clock_offset_ns: 0,
            intrinsics_px: [0.0; 4],
            size_px: [0; 2],
            world_from_camera: WireTransform::IDENTITY,
            up_in_camera: [0.0; 3],
            location: SegmentLocation::default(),
            source_name: Text::default(),
            reserved: 0,
        }
    }
}

impl FrameHeader {
    /// Whether a flag of [`frame_flag`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Writes intrinsics and size.
    pub fn set_camera(&mut self, camera: &PinholeCamera) {
        self.intrinsics_px = [camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px];
        self.size_px = [camera.width, camera.height];
    }

    /// Checks all numbers of the header against each other and the points.
    ///
    /// # Errors
    /// Says which number is impossible.
    pub fn checked(&self, n_points: usize) -> Result<CheckedFrame, InvalidFrame> {
        if self.schema_version != SCHEMA_VERSION {
            return Err(InvalidFrame::SchemaVersion(self.schema_version));
        }
        let ([fx_px, fy_px, cx_px, cy_px], [width, height]) = (self.intrinsics_px, self.size_px);
        let camera = PinholeCamera {
            fx_px,
            fy_px,
            cx_px,
            cy_px,
            width,
            height,
        }
        .validated()
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

fn checked_direction(direction: [f64; 3]) -> Option<Unit<Vector3<f64>>> {
    let direction = Vector3::from(direction);
    let length = direction.norm();
    (length.is_finite() && (length - 1.0).abs() < 1e-3).then(|| Unit::new_normalize(direction))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let frame = good().checked(640 * 480).unwrap();
        assert_eq!(frame.camera, PinholeCamera::KINECT_V1);
        assert_eq!(frame.world_from_camera, Some(RigidTransform::identity()));
    }

    #[test]
    fn each_impossible_number_is_named() {
        let check = |change: &dyn Fn(&mut FrameHeader), n_points: usize, word: &str| {
            let mut header = good();
            change(&mut header);
            let sentence = header.checked(n_points).unwrap_err().to_string();
            assert!(sentence.contains(word), "{sentence}");
        };
        let full = 640 * 480;
        check(&|h| h.schema_version = 99, full, "version 99");
        check(&|h| h.intrinsics_px[0] = f64::NAN, full, "intrinsics");
        check(&|h| h.size_px = [u32::MAX, u32::MAX], full, "intrinsics");
        check(&|_| (), full - 1, "points");
        check(&|h| h.world_from_camera.rows[0][0] = 5.0, full, "rigid");
        check(&|h| h.up_in_camera = [0.0; 3], full, "gravity");
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
