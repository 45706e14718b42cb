//! Rigid transforms, pinhole camera, plane, convex polygon, bounding rectangle, oriented box
//! and capsule.
//!
//! Units are metres and radians; estimates are `f64`. A transform is named
//! `target_from_source`, so that products read like a chain.
//!
//! This crate never does I/O, never allocates except where a `Vec` is returned,
//! and knows nothing about point clouds.
//!
//! # Example
//!
//! ```
//! use geometry::{PinholeCamera, Plane, RigidTransform};
//! use nalgebra::{Point3, Vector3};
//!
//! let camera = PinholeCamera::KINECT_V1;
//! let point_in_camera = camera.back_project(319.5, 239.5, 1.2);
//! let world_from_camera = RigidTransform::new(Vector3::new(0.0, 0.0, 1.5), Vector3::zeros());
//! let floor = Plane::through(&Point3::origin(), Vector3::z_axis());
//! assert!((floor.height_m(&(world_from_camera * point_in_camera)) - 2.7).abs() < 1e-12);
//! ```

mod bounding_rectangle;
mod capsule;
mod convex_polygon;
mod oriented_box;
mod pinhole_camera;
mod plane;

pub use bounding_rectangle::BoundingRectangle;
pub use capsule::Capsule;
pub use convex_polygon::ConvexPolygon;
pub use oriented_box::OrientedBox;
pub use pinhole_camera::{InvalidIntrinsics, PinholeCamera};
pub use plane::Plane;

/// Rigid transform (isometry): rotation and translation, metres.
pub type RigidTransform = nalgebra::Isometry3<f64>;
