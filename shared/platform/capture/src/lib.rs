//! Capture loop: publishes the frames of a camera on schedule or in lockstep.
//!
//! A [`Source`] fills a loan of shared memory directly, as late as is safe; the
//! [`CaptureLoop`] sends it when it is due and counts late frames, or waits in
//! lockstep for the processes that handle it. Subscribers of `camera/cloud` cannot
//! distinguish the sources. The raw images of a frame follow it while somebody subscribes
//! to them. A source or shared memory that fails after the first frame is
//! an [`Outage`]: the loop tries again until it works.
//!
//! ```
//! use capture::{FrameInfo, FrameSize, Source, SourceError};
//! use geometry::PinholeCamera;
//! use point_cloud::Point;
//!
//! /// Source of one frame, a plane at one metre.
//! struct Plane(usize);
//!
//! impl Source for Plane {
//!     fn name(&self) -> &str {
//!         "plane"
//!     }
//!     fn rate_hz(&self) -> Option<f64> {
//!         Some(30.0)
//!     }
//!     fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
//!         self.0 += 1;
//!         Ok((self.0 == 1).then_some(FrameSize { width: 4, height: 3 }))
//!     }
//!     fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
//!         points.fill(Point { z: 1.0, ..Point::default() });
//!         Ok(FrameInfo {
//!             camera: PinholeCamera {
//!                 fx_px: 4.0, fy_px: 4.0, cx_px: 1.5, cy_px: 1.0, width: 4, height: 3,
//!             },
//!             is_calibrated: false,
//!             world_from_camera: None,
//!             up_in_camera: None,
//!             source_frame: 0,
//!             captured_ns: None,
//!         })
//!     }
//! }
//!
//! let mut source = Plane(0);
//! let size = source.prepare()?.ok_or(SourceError::EndOfRecording)?;
//! let mut points = vec![Point::default(); size.n_points()];
//! assert_eq!(source.fill(&mut points)?.camera.width, 4);
//! assert_eq!(source.prepare()?, None);
//! # Ok::<(), SourceError>(())
//! ```

mod capture_loop;
mod frame_follower;
mod image_publisher;
mod lead_time;
mod lockstep;
mod outage;
mod schedule;
mod source;
mod source_error;
mod source_images;

pub use capture_loop::{CaptureEnd, CaptureLoop};
pub use frame_follower::{FollowedFrame, FrameFollower};
pub use lockstep::{Follower, FramePace};
pub use outage::Outage;
pub use source::{FrameInfo, FrameSize, IdleUpdate, Source};
pub use source_error::SourceError;
pub use source_images::{DepthPixels, SourceImages, rounded_mm};
