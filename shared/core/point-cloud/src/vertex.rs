//! Vertex of a coloured surface.

use nalgebra::{Point3, Vector3};

/// Vertex of a mesh; smooth faces share vertices, faces at a crease do not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Position of the vertex in the mesh's frame, metres.
    pub position: Point3<f32>,
    /// Outward unit normal of the vertex.
    pub normal: Vector3<f32>,
    /// Diffuse colour of the vertex, sRGB: red, green, blue.
    pub color: [u8; 3],
}
