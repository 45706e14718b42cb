//! Software renderer and Kinect sensor model: meshes to depth, colour and instance masks.
//!
//! A [`Rasterizer`] draws [`Instance`]s of [`PreparedMesh`]es into an [`Image`]: exact depth,
//! instance id, colour and reflection of every pixel. Static instances are drawn once as a
//! background. A [`kinect::KinectSensor`] turns the image into a measurement, by a
//! [`kinect::SensorModel`] whose error terms can be switched off one by one.
//!
//! Frames: the camera's x points right, y down, z forward; pixel centres have integer
//! coordinates. The world's z points up, which only the ambient light uses.
//!
//! ```
//! use geometry::{PinholeCamera, RigidTransform};
//! use point_cloud::Point;
//! use rendering::kinect::{KinectSensor, SensorModel};
//! use rendering::{Instance, PreparedMesh, Rasterizer};
//!
//! let camera = PinholeCamera::KINECT_V1;
//! let cube = PreparedMesh::new(&mesh::rounded_box([0.2; 3], 0.01, 0.1).mesh);
//! let pose = RigidTransform::translation(0.0, 0.0, 1.0);
//! let mut rasterizer = Rasterizer::new(camera)?;
//! let image = rasterizer.render(&[Instance::new(&cube, pose, 7)]);
//! let middle = 240 * 640 + 320;
//! assert_eq!(image.instance()[middle], 7);
//! assert!((image.depth_m()[middle] - 0.9).abs() < 1e-3);
//!
//! let mut sensor = KinectSensor::new(camera, SensorModel::KINECT_V1)?;
//! let mut points = vec![Point::default(); camera.n_pixels()];
//! sensor.sense(image, Default::default(), &mut points)?;
//! assert!((points[middle].z - 0.9).abs() < 0.02);
//! # Ok::<(), rendering::Error>(())
//! ```
//!
//! Invariants: this crate does no I/O, never reads a clock and starts no thread. All randomness
//! comes from a seed and a frame index. Nothing is allocated per frame once the buffers have
//! grown, and no input makes it panic.

mod background;
mod blinn_phong;
mod deferred_shader;
mod dirty_shadow_blocks;
mod error;
mod face_cache;
mod illuminant;
mod image;
mod instance;
pub mod kinect;
mod lanes;
mod lights;
mod lit_pixel;
mod near_clip;
mod pixel_block;
mod pixel_rays;
mod prepared_mesh;
mod projected_mesh;
mod projection;
mod radiance;
mod rasterizer;
mod reflection;
mod rounding;
mod scanline;
mod shadow_bounds;
mod shadow_grid;
mod shadow_map;
mod surface_attributes;
mod texture;
mod visibility_buffer;

pub use error::Error;
pub use illuminant::Illuminant;
pub use image::Image;
pub use instance::Instance;
pub use lights::{Light, LightPlacement, Lights, ShadowRegion};
pub use prepared_mesh::PreparedMesh;
pub use radiance::LINEAR_ONE;
pub use rasterizer::{Rasterizer, StaticScene};
pub use reflection::Reflection;
pub use texture::Texture;
