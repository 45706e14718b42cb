//! Kinect v1 sensor model: depth and colour errors of a structured-light camera, and of an active
//! stereo camera.
//!
//! [`SensorModel`] lists the error terms; each of them has its own file in this folder.
//! [`KinectSensor`] applies them in the order of the real chain: projection of the pattern,
//! matching, triangulation, colour.

mod axial_noise;
mod color_response;
mod depth_discontinuity;
mod disparity_quantisation;
mod edge_fattening;
mod lateral_noise;
mod matching_window;
mod missing_depth;
mod noise_tables;
mod projector_shadow;
mod sensor;
mod sensor_model;

pub use axial_noise::AxialNoise;
pub use color_response::ColorResponse;
pub use disparity_quantisation::DisparityQuantisation;
pub use edge_fattening::EdgeFattening;
pub use lateral_noise::LateralNoise;
pub use matching_window::MatchingWindow;
pub use missing_depth::{BorderSpeckle, DepthRange, WeakSignal};
pub use projector_shadow::ProjectorShadow;
pub use sensor::{FrameSeed, KinectSensor};
pub use sensor_model::SensorModel;
