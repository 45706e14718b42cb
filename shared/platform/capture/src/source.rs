//! Camera source interface: live, recorded or simulated.

use crate::source_error::SourceError;
use crate::source_images::SourceImages;
use channel::topic::MAX_FRAME_POINTS;
use geometry::{PinholeCamera, RigidTransform};
use message::FrameHeader;
use nalgebra::{Unit, Vector3};
use point_cloud::Point;

/// Frame size in columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameSize {
    /// Number of columns of the frame.
    pub width: usize,
    /// Number of rows of the frame.
    pub height: usize,
}

impl FrameSize {
    /// Size of the images of a camera.
    pub fn of(camera: &PinholeCamera) -> Self {
        Self {
            width: camera.width as usize,
            height: camera.height as usize,
        }
    }

    /// Number of points of the frame.
    pub fn n_points(self) -> usize {
        self.width * self.height
    }
}

/// Metadata of a captured frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameInfo {
    /// Camera intrinsics with the image size.
    pub camera: PinholeCamera,
    /// `true` when the intrinsics belong to this camera; `false` when they are
    /// nominal.
    pub is_calibrated: bool,
    /// Pose of the camera, when known.
    pub world_from_camera: Option<RigidTransform>,
    /// Up direction (against gravity) in the camera frame, when known.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Index of the frame in its recording.
    pub source_frame: usize,
    /// Capture time of a live sensor, monotonic, nanoseconds; `None` for recordings.
    pub captured_ns: Option<u64>,
}

/// Camera source, live, recorded or simulated.
pub trait Source {
    /// Name of the camera source, for people.
    fn name(&self) -> &str;

    /// Playback rate, frames per second; `None` for a live sensor, whose frames are
    /// sent as they arrive.
    fn rate_hz(&self) -> Option<f64>;

    /// Time of the prepared frame on the recording's own clock, nanoseconds: frames are then sent
    /// at the intervals of these times, which never go back, instead of at the rate.
    fn frame_time_ns(&self) -> Option<u64> {
        None
    }

    /// Number of points of the largest frame, for which memory is reserved at the start.
    fn max_points(&self) -> usize {
        MAX_FRAME_POINTS
    }

    /// Prepares the next frame and returns its size; `None` at the end. It is filled
    /// later, as late as is safe: the content is determined here, and drawn there.
    ///
    /// # Errors
    /// When a frame cannot be used (the next call continues after it), or the device
    /// is lost.
    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError>;

    /// Fills the prepared frame, every point of it; `points` has the prepared size.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError>;

    /// Raw images of the frame that was filled last, asked for only while somebody subscribes
    /// to them. `None` for a source without images: its organised cloud gives them, pixel by
    /// pixel.
    fn images(&self) -> Option<SourceImages<'_>> {
        None
    }

    /// Called repeatedly while the prepared frame waits to be filled, without
    /// `points`, and while the filled frame waits for its scheduled time `due_ns`,
    /// monotonic. A source may do small work here, and may rewrite a filled frame
    /// when the world has changed.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn while_waiting(
        &mut self,
        _due_ns: u64,
        _points: Option<&mut [Point]>,
    ) -> Result<IdleUpdate, SourceError> {
        Ok(IdleUpdate::default())
    }

    /// Completes the header of the filled frame. A recording sets the numbers here that would not
    /// survive the conversion from and to [`FrameInfo`] to the bit.
    fn complete_header(&self, _header: &mut FrameHeader) {}

    /// Called before the frame is sent, with its header. Data published here is there
    /// when the frame arrives.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn before_send(&mut self, _header: &FrameHeader) -> Result<(), SourceError> {
        Ok(())
    }

    /// Called after the frame was sent, with its header.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn after_send(&mut self, _header: &FrameHeader) -> Result<(), SourceError> {
        Ok(())
    }
}

/// Result of waiting: a rewritten frame and the time of the next call.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IdleUpdate {
    /// Metadata of the frame if the source rewrote it.
    pub rewritten: Option<FrameInfo>,
    /// Time of the next call wanted by the source, monotonic, nanoseconds; it may
    /// come earlier.
    pub next_call_ns: Option<u64>,
}
