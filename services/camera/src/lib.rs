//! The sensor: a Kinect, a fakenect folder, a recorded sequence, a folder of
//! scenes or a synthetic table, published as organised clouds.
//!
//! Each is a [`capture::Source`]; the capture loop sends its frames.

mod arguments;
mod config;
mod fakenect_restart;
mod intrinsics_fit;
mod run;
mod source;
pub mod synthetic;

pub use arguments::Arguments;
pub use config::Config;
pub use fakenect_restart::enter_recording;
pub use run::{PlayAgain, check_source, run};
