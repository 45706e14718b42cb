//! Camera service: a Kinect, a fakenect recording, an RGB-D sequence, a folder of scenes
//! or a synthetic table, published as organised point clouds.
//!
//! Each is a [`capture::Source`]; the capture loop sends its frames.

mod arguments;
mod config;
mod fakenect_restart;
mod intrinsics_fit;
mod run;
mod source;
pub mod synthetic;

pub use arguments::CameraArguments;
pub use config::Config;
pub use fakenect_restart::restart_with_recording;
pub use run::{ReplayRequest, check_source, run};
