//! Renders meshes as a Kinect sees them: rasteriser and sensor error model.
//!
//! A [`Rasterizer`] draws [`Instance`]s of [`PreparedMesh`]es into an [`Image`]:
//! exact depth, instance, colour and reflection of every pixel. What does not
//! move is drawn once as its background. A [`kinect::KinectSensor`] turns the
//! image into what the sensor would measure, by a [`kinect::SensorModel`] whose
//! error terms can be switched off one by one.
//!
//! Frames: the camera's x points right, y down, z forward; a pixel's centre has
//! whole coordinates. The world's z points up, which only the light of the
//! surroundings uses.
//!
//! Invariants: this crate never does I/O, never reads a clock, starts no thread,
//! draws all randomness from a seed and a frame index, allocates nothing per
//! frame once its buffers have grown, and no input makes it panic.

mod background;
mod error;
mod face_view;
mod illuminant;
mod image;
mod instance;
pub mod kinect;
mod lights;
mod near_clip;
mod pixel_block;
mod prepared_mesh;
mod projection;
mod rasterizer;
mod reflected_light;
mod scanline;
mod seen_face;
mod shader;
mod shading;
mod shadow_bounds;
mod shadow_map;
mod shadow_reach;
mod texture;
mod visibility;
mod whole_number;

pub use error::Error;
pub use illuminant::Illuminant;
pub use image::{Image, LINEAR_ONE, Reflection};
pub use instance::Instance;
pub use lights::{Light, LightPlacement, Lights, ShadowRegion};
pub use prepared_mesh::PreparedMesh;
pub use rasterizer::{Rasterizer, Stage};
pub use texture::Texture;
