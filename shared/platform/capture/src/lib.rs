//! Publishes the frames of a source at their instants.
//!
//! A [`Source`] fills a loan of shared memory directly, as late as is safe; the [`CaptureLoop`] sends
//! it when it is due, counts lateness, or waits for the followers in lockstep.
//! Nothing above `camera/cloud` can tell the sources apart.

mod capture_loop;
mod lead_time;
mod lockstep;
mod schedule;
mod source;
mod source_error;

pub use capture_loop::{CaptureLoop, End};
pub use source::{FrameInfo, FrameSize, Source, Waiting};
pub use source_error::SourceError;
