//! Coloured triangle mesh.

use point_cloud::Vertex;

/// Reflectance of a face apart from its colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Specular fraction: 0 matte, 0.3 glazed, 0.9 polished metal.
    pub specular: f32,
    /// Infrared reflectance relative to that suggested by the brightness of the colour: 1 usual,
    /// 0.1 for surfaces that are black in infrared.
    pub infrared: f32,
}

impl Surface {
    /// Diffuse (Lambertian) surface.
    pub const MATTE: Self = Self {
        specular: 0.0,
        infrared: 1.0,
    };
}

/// Triangle, counter-clockwise seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    /// Corner vertices: indices into [`TriangleMesh::vertices`].
    pub vertices: [u32; 3],
    /// Surface finish: index into [`TriangleMesh::surfaces`].
    pub surface: u8,
}

/// Coloured triangle mesh, metres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriangleMesh {
    /// Vertices of the mesh.
    pub vertices: Vec<Vertex>,
    /// Triangles of the mesh.
    pub triangles: Vec<Triangle>,
    /// Surfaces of the faces; at most 256.
    pub surfaces: Vec<Surface>,
}
