//! Triangle meshes: building, validation, mass properties, convex decomposition.
//!
//! Units are metres. A mesh may consist of several closed components that
//! overlap; a point inside any of them is inside the object.
//!
//! This crate does no I/O and knows nothing about rendering.
//!
//! # Example
//!
//! ```
//! use mesh::rounded_box;
//!
//! let solid = rounded_box([0.1, 0.2, 0.3], 0.0, 0.05);
//! assert!((solid.mesh.signed_volume() - 0.006).abs() < 1e-6);
//! assert!(solid.mesh.diagnostics().is_sound());
//! assert_eq!(solid.convex_parts.len(), 1);
//! ```

mod connected_components;
mod contact_faces;
mod convex_decomposition;
mod convex_part;
mod decimation;
mod diagnostics;
mod doubled_faces;
mod extrusion;
mod mass_properties;
mod mesh_editing;
mod revolution;
mod rounded_box;
mod solid;
mod superellipsoid;
mod surface_builder;
mod triangle_mesh;
mod triangulation;
mod tube;
mod vertex_normals;
mod welding;

pub use contact_faces::simplify_contact_faces;
pub use convex_decomposition::{convex_decomposition, simplify_polygon};
pub use convex_part::{ConvexPart, MAX_HULL_POINTS};
pub use diagnostics::MeshDiagnostics;
pub use extrusion::extrude;
pub use mass_properties::Bounds;
pub use point_cloud::Vertex;
pub use revolution::lathe;
pub use rounded_box::rounded_box;
pub use solid::Solid;
pub use superellipsoid::{ellipsoid, superellipsoid};
pub use triangle_mesh::{Surface, Triangle, TriangleMesh};
pub use triangulation::triangulate;
pub use tube::{TubeSection, rounded_tube, tube};
