//! Triangle meshes: building, checking, measuring.
//!
//! Units are metres. A mesh may consist of several closed parts that overlap;
//! what is inside any of them is inside the object.
//!
//! This crate does no I/O and knows nothing about how a mesh is looked at.

mod assembly;
mod closed_surface;
mod connected_parts;
mod convex_part;
mod convex_pieces;
mod decimation;
mod examination;
mod extrusion;
mod measures;
mod revolution;
mod rounded_box;
mod smooth_normals;
mod solid;
mod superellipsoid;
mod support_faces;
mod triangle_mesh;
mod triangulation;
mod tube;
mod welding;

pub use convex_part::{ConvexPart, N_POINTS_MAX};
pub use convex_pieces::{convex_pieces, simplified};
pub use examination::Examination;
pub use extrusion::extrude;
pub use measures::Bounds;
pub use revolution::lathe;
pub use rounded_box::rounded_box;
pub use solid::Solid;
pub use superellipsoid::{ellipsoid, superellipsoid};
pub use support_faces::with_four_cornered_faces;
pub use triangle_mesh::{Surface, Triangle, TriangleMesh, Vertex};
pub use triangulation::triangulate;
pub use tube::{TubeSection, rounded_tube, tube};
