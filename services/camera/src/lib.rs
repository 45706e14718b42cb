//! Camera service: a Kinect, a fakenect recording, an RGB-D sequence, a folder of images or
//! scenes, or a synthetic table, published as organised point clouds.
//!
//! Each is a [`capture::Source`]; the capture loop sends its frames. The synthetic table
//! also serves as ground truth in tests:
//!
//! ```
//! use camera::synthetic::SyntheticTable;
//! use point_cloud::Point;
//!
//! let table = SyntheticTable::new(0);
//! let mut points = vec![Point::default(); table.camera().n_pixels()];
//! table.fill(0, &mut points);
//! assert_eq!(table.objects().len(), 5);
//! let n_measured = points.iter().filter(|point| point.is_finite()).count();
//! assert!(n_measured > points.len() / 2);
//! ```

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
