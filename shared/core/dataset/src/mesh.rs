//! Triangle meshes with coloured vertices, as files hold them.

use point_cloud::Point;

/// Most vertices of one file.
pub const MAX_VERTICES: usize = 1 << 24;

/// Most triangles of one file.
pub const MAX_TRIANGLES: usize = 1 << 25;

/// Most bytes of one file.
pub const MAX_BYTES: u64 = 1 << 29;

/// The content of a file with a mesh. What the readers of this crate return has
/// finite coordinates, and its triangles name vertices that are there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The vertices with their colours, in the units and frame of the file.
    pub vertices: Vec<Point>,
    /// Three indices of vertices for each triangle, in the order of the file.
    pub triangles: Vec<[u32; 3]>,
}

/// A borrowed mesh, for writing.
#[derive(Debug, Clone, Copy)]
pub struct MeshView<'a> {
    /// The vertices with their colours.
    pub vertices: &'a [Point],
    /// Three indices of vertices for each triangle; none for a set of points.
    pub triangles: &'a [[u32; 3]],
}

impl Mesh {
    /// Borrows the content for writing.
    pub fn view(&self) -> MeshView<'_> {
        MeshView {
            vertices: &self.vertices,
            triangles: &self.triangles,
        }
    }
}
