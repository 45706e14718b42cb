//! Kinect v1 driver: libfreenect, loaded at run time, with a safe wrapper.
//!
//! The C library is searched for when a camera is opened, never at build time, so that everything
//! builds and runs on machines without it. Debian's package `libfreenect0.5` contains two
//! libraries with the same functions: the real one, and fakenect, which plays a recorded folder.
//! The choice is made at start ([`LibraryKind`]); all code after that choice is the same.
//!
//! ```no_run
//! use freenect::{Calibration, CloudBuilder, Kinect, Library, LibraryKind, Selector};
//! use point_cloud::Point;
//! use std::{sync::Arc, time::Duration};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let library = Arc::new(Library::load(LibraryKind::Real)?);
//! let mut kinect = Kinect::open(library, &Selector::Index(0))?;
//! let builder = CloudBuilder::new(&Calibration::nominal())?;
//! let mut cloud = vec![Point::default(); freenect::N_PIXELS];
//! while let Some(frame) = kinect.next_frame(Duration::from_millis(500))? {
//!     builder.fill(frame.depth.pixels, frame.video.pixels, &mut cloud)?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Invariants: this crate links nothing at build time, starts no thread, sets no environment
//! variable, and logs nothing (the library's log messages are kept for the caller). It passes
//! fakenect only folders it has checked, because fakenect ends the process over a missing file
//! and reads past short ones.
//!
//! `unsafe` is confined to `raw`, `library`, `messages`, `frame_buffer`, `callbacks` and
//! `session`; everything else is safe code over them.

mod acceleration;
mod calibration;
mod callbacks;
mod depth;
mod device;
mod error;
mod frame;
mod frame_buffer;
mod library;
mod library_kind;
mod mapped_file;
mod messages;
mod pairing;
mod presence;
mod raw;
mod recording;
mod registration;
mod restart;
mod selector;
mod session;

pub use acceleration::Acceleration;
pub use calibration::{Calibration, InvalidCalibration};
pub use depth::{DepthFormula, DepthTable, MAX_DEPTH_M, NO_DEPTH};
pub use device::Kinect;
pub use error::Error;
pub use frame::{Image, KinectFrame};
pub use library::Library;
pub use library_kind::LibraryKind;
pub use messages::{LogLevel, LogMessage};
pub use pairing::{CLOCK_HZ, PAIRING_WINDOW_TICKS, PairingStatistics};
pub use presence::{Access, Presence, UsbPart, UsbPartKind};
pub use raw::{HEIGHT, N_PIXELS, WIDTH};
pub use recording::{MAX_PAUSE, RecordingError, RecordingSummary, check_recording};
pub use registration::{CloudBuilder, FillSummary, NEUTRAL_GREY, WrongSize};
pub use restart::{FOLDER_VARIABLE, restart_with_recording};
pub use selector::Selector;
