//! A camera, live, recorded or simulated.

use crate::source_error::SourceError;
use geometry::{PinholeCamera, RigidTransform};
use message::FrameHeader;
use nalgebra::{Unit, Vector3};
use point_cloud::Point;

/// Columns and rows of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameSize {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl FrameSize {
    /// Number of points.
    pub fn n_points(self) -> usize {
        self.width * self.height
    }
}

/// What a source says about a frame it has filled.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameInfo {
    /// Intrinsics and size.
    pub camera: PinholeCamera,
    /// Whether the intrinsics belong to this camera or are nominal.
    pub is_calibrated: bool,
    /// Pose of the camera, when known.
    pub world_from_camera: Option<RigidTransform>,
    /// Direction against gravity, when known.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Number of the frame in its recording.
    pub source_frame: usize,
    /// When a live sensor captured the frame, monotonic; `None` for recordings.
    pub captured_ns: Option<u64>,
}

/// A camera, live or recorded.
pub trait Source {
    /// What people call it.
    fn name(&self) -> &str;

    /// Frames per second it wants to be played at; `None` for a live sensor,
    /// whose frames are sent as they come.
    fn rate_hz(&self) -> Option<f64>;

    /// Gets the next frame ready and says how large it is; `None` at the end. It is
    /// filled later, as late as is safe, so that what the frame shows is done here and
    /// drawing it there.
    ///
    /// # Errors
    /// When a frame can not be used (the next call goes on behind it), or the
    /// device is gone.
    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError>;

    /// Writes the prepared frame, every point of it; `points` has the prepared size.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError>;

    /// Called again and again while the prepared frame waits to be filled, without
    /// `points`, and while the filled frame waits for its instant `due_ns`,
    /// monotonic. A source may do small work here, and may write a filled frame anew
    /// when the world has changed.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn while_waiting(
        &mut self,
        _due_ns: u64,
        _points: Option<&mut [Point]>,
    ) -> Result<Waiting, SourceError> {
        Ok(Waiting::default())
    }

    /// Called when the frame is about to be sent, with its header. What belongs to
    /// the frame and is published here is there when the frame comes.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn sending(&mut self, _header: &FrameHeader) -> Result<(), SourceError> {
        Ok(())
    }

    /// Called when the frame has been sent, with the header it was sent with.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn sent(&mut self, _header: &FrameHeader) -> Result<(), SourceError> {
        Ok(())
    }
}

/// What a source wants while its frame waits.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Waiting {
    /// The frame has been written anew and is now this.
    pub rewritten: Option<FrameInfo>,
    /// When the source wants to be called again, monotonic; it may be called earlier.
    pub again_ns: Option<u64>,
}
