//! A coloured triangle mesh.

use nalgebra::{Point3, Vector3};

/// One corner; corners of different smooth faces do not share a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Position in the mesh's frame, metres.
    pub position: Point3<f32>,
    /// Outward unit normal.
    pub normal: Vector3<f32>,
    /// Diffuse colour, sRGB: red, green, blue.
    pub color: [u8; 3],
}

/// How a face reflects light besides its colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Share of mirror-like reflection: 0 matte, 0.3 glazed, 0.9 polished metal.
    pub specular: f32,
    /// Share of the projector's infrared light that is scattered back, relative
    /// to what the colour's brightness suggests: 1 usual, 0.1 for what is black in infrared.
    pub infrared: f32,
}

impl Surface {
    /// Scatters light in all directions.
    pub const MATTE: Self = Self {
        specular: 0.0,
        infrared: 1.0,
    };
}

/// Three vertices, counter-clockwise seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into [`TriangleMesh::vertices`].
    pub vertices: [u32; 3],
    /// Index into [`TriangleMesh::surfaces`].
    pub surface: u8,
}

/// A coloured triangle mesh, metres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriangleMesh {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Faces.
    pub triangles: Vec<Triangle>,
    /// Reflection of the faces; at most 256.
    pub surfaces: Vec<Surface>,
}
