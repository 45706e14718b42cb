//! Document of a full object model: the coloured surface fused from views of an object, the views,
//! and the directions from which it was never seen.
//!
//! Units are metres, in the frame of the object: z points up as the object stood, and angles are
//! counted from x towards y. [`ObjectModel::to_bytes`] and [`ObjectModel::from_bytes`] are the
//! form in which the memory keeps a model; [`ObjectModel::to_ply`] is for other programs.
//!
//! This crate does no I/O. Any bytes are read or refused with a sentence, in memory that is
//! proportional to them.
//!
//! # Example
//!
//! ```
//! use point_cloud::Vertex;
//! use nalgebra::{Point3, Vector3};
//! use object_model::{DirectionSphere, ModelMesh, ObjectModel, UnseenDirections};
//!
//! let vertex = |x, y| Vertex {
//!     position: Point3::new(x, y, 0.0),
//!     normal: Vector3::z(),
//!     color: [200, 30, 30],
//! };
//! let model = ObjectModel {
//!     mesh: ModelMesh {
//!         vertices: vec![vertex(0.0, 0.0), vertex(0.1, 0.0), vertex(0.0, 0.2)],
//!         triangles: vec![[0, 1, 2]],
//!     },
//!     views: Vec::new(),
//!     refused: Vec::new(),
//!     is_closed_loop: false,
//!     unseen: UnseenDirections::of(DirectionSphere::Icosphere42, |direction| direction.z < -0.8),
//! };
//! let bytes = model.to_bytes().unwrap();
//! assert_eq!(ObjectModel::from_bytes(&bytes).unwrap(), model);
//! assert!((model.summary().extents_m[1] - 0.2).abs() < 1e-6);
//! assert_eq!(model.unseen.in_words(), ["the underside"]);
//! ```

mod direction_sphere;
mod document;
mod error;
mod model;
mod ply_export;
mod summary;
mod unseen_directions;
mod validation;

pub use direction_sphere::DirectionSphere;
pub use document::{MEDIA_TYPE, VERSION};
pub use error::Error;
pub use model::{ModelMesh, ModelView, ObjectModel, RefusedView};
pub use summary::ModelSummary;
pub use unseen_directions::UnseenDirections;
pub use validation::{MAX_COORDINATE_M, MAX_REASON_BYTES};
