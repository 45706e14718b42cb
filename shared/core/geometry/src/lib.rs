//! Rigid transforms, pinhole camera, plane, polygon, oriented box and capsule.
//!
//! Units are metres and radians; estimates are `f64`. A transform is named
//! `target_from_source`, so that products read like a chain.
//!
//! This crate never does I/O, never allocates except where a `Vec` is returned,
//! and knows nothing about point clouds.

mod capsule;
mod convex_polygon;
mod oriented_box;
mod pinhole_camera;
mod plane;

pub use capsule::Capsule;
pub use convex_polygon::ConvexPolygon;
pub use oriented_box::OrientedBox;
pub use pinhole_camera::{InvalidIntrinsics, PinholeCamera};
pub use plane::Plane;

/// A rigid transform: rotation and translation, metres.
pub type RigidTransform = nalgebra::Isometry3<f64>;
