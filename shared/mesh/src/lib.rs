//! Triangle meshes: building, checking, measuring.
//!
//! Units are metres. A mesh may consist of several closed parts that overlap;
//! what is inside any of them is inside the object.
//!
//! This crate does no I/O and knows nothing about how a mesh is looked at.

mod triangle_mesh;

pub use triangle_mesh::{Surface, Triangle, TriangleMesh, Vertex};
