//! File content of triangle meshes with coloured vertices.

use point_cloud::Point;

/// Maximum number of vertices of one file.
pub const MAX_VERTICES: usize = 1 << 24;

/// Maximum number of triangles of one file.
pub const MAX_TRIANGLES: usize = 1 << 25;

/// Maximum size of one mesh file, bytes.
pub const MAX_BYTES: u64 = 1 << 29;

/// Triangle mesh of a file. The readers of this crate guarantee finite coordinates and valid
/// vertex indices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Vertices with their colours, in the units and frame of the file.
    pub vertices: Vec<Point>,
    /// Vertex indices of each triangle, in the order of the file.
    pub triangles: Vec<[u32; 3]>,
}

/// Borrowed mesh, for writing.
#[derive(Debug, Clone, Copy)]
pub struct MeshView<'a> {
    /// Vertices with their colours.
    pub vertices: &'a [Point],
    /// Vertex indices of each triangle; empty for a point set.
    pub triangles: &'a [[u32; 3]],
}

impl Mesh {
    /// Borrows the mesh for writing.
    pub fn view(&self) -> MeshView<'_> {
        MeshView {
            vertices: &self.vertices,
            triangles: &self.triangles,
        }
    }
}
