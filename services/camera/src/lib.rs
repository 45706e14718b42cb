//! The sensor: a Kinect, a fakenect folder, a recorded sequence, a folder of
//! scenes or a synthetic table, published as organised clouds.
//!
//! A [`source`](Source) fills a loan of shared memory directly; the capture loop
//! sends it at its scheduled instant. Nothing above `camera/cloud` can tell the
//! sources apart.

mod arguments;
mod capture;
mod config;
mod fakenect_restart;
mod intrinsics_fit;
mod lockstep;
mod run;
mod schedule;
mod source;
pub mod synthetic;

pub use arguments::Arguments;
pub use config::Config;
pub use fakenect_restart::enter_recording;
pub use run::{PlayAgain, check_source, run};
