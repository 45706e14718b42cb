//! What a Kinect v1 measures of a rendered image.
//!
//! [`SensorModel`] says which errors it makes; each of them is a file of this
//! folder, named after it. [`KinectSensor`] applies them in the order of the
//! real chain: light of the projector, matching, triangulation, colour.

mod axial_noise;
mod color_response;
mod depth_border;
mod disparity_quantisation;
mod edge_fattening;
mod lateral_noise;
mod missing_depth;
mod noise_source;
mod projector_shadow;
mod sensor;
mod sensor_model;

pub use axial_noise::AxialNoise;
pub use color_response::ColorResponse;
pub use disparity_quantisation::DisparityQuantisation;
pub use edge_fattening::EdgeFattening;
pub use lateral_noise::LateralNoise;
pub use missing_depth::{BorderSpeckle, DepthRange, WeakSignal};
pub use projector_shadow::ProjectorShadow;
pub use sensor::{KinectSensor, Shot};
pub use sensor_model::SensorModel;
