//! Export of a model's surface as PLY with vertex colours.

use crate::error::Error;
use crate::model::ObjectModel;
use ply::{Encoding, MeshView};
use point_cloud::{Point, Rgba, Vertex};

impl ObjectModel {
    /// Surface as a binary little-endian PLY file with vertex colours, metres, in the frame of the
    /// object; without normals.
    ///
    /// # Errors
    /// When the model has more vertices or triangles than a PLY file may have, or is invalid.
    pub fn to_ply(&self) -> Result<Vec<u8>, Error> {
        let point = |vertex: &Vertex| {
            let [red, green, blue] = vertex.color;
            Point {
                x: vertex.position.x,
                y: vertex.position.y,
                z: vertex.position.z,
                color: Rgba::opaque(red, green, blue),
            }
        };
        let vertices: Vec<Point> = self.mesh.vertices.iter().map(point).collect();
        let mesh = MeshView {
            vertices: &vertices,
            triangles: &self.mesh.triangles,
        };
        Ok(ply::write(mesh, Encoding::BinaryLittleEndian)?)
    }
}
