//! Builder of closed surfaces from points and faces.

use crate::{Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, Vector3};

/// Crease angle, radians: edges between faces at a greater angle stay sharp. Chosen.
pub(crate) const CREASE_RAD: f32 = 0.7;

/// Default colour of meshes without colours: light grey.
const UNPAINTED: [u8; 3] = [200, 200, 200];

/// Builder of a closed surface.
#[derive(Default)]
pub(crate) struct SurfaceBuilder {
    pub(crate) points: Vec<Point3<f32>>,
    faces: Vec<[u32; 3]>,
}

impl SurfaceBuilder {
    /// Adds a point; returns its index.
    pub(crate) fn point(&mut self, point: Point3<f32>) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }

    /// Adds a triangle, unless two of its corners coincide.
    pub(crate) fn triangle(&mut self, a: u32, b: u32, c: u32) {
        let at = |i: u32| self.points[i as usize];
        if at(a) != at(b) && at(b) != at(c) && at(c) != at(a) {
            self.faces.push([a, b, c]);
        }
    }

    /// Adds a quadrilateral, split along its shorter diagonal.
    pub(crate) fn quad(&mut self, a: u32, b: u32, c: u32, d: u32) {
        let length = |i: u32, k: u32| (self.points[i as usize] - self.points[k as usize]).norm();
        if length(a, c) <= length(b, d) {
            self.triangle(a, b, c);
            self.triangle(a, c, d);
        } else {
            self.triangle(a, b, d);
            self.triangle(b, c, d);
        }
    }

    /// Connects two rings with equal numbers of points by quadrilaterals.
    pub(crate) fn band(&mut self, lower: &[u32], upper: &[u32]) {
        for i in 0..lower.len() {
            let k = (i + 1) % lower.len();
            self.quad(lower[i], lower[k], upper[k], upper[i]);
        }
    }

    /// Connects a ring with a central point by triangles.
    pub(crate) fn fan(&mut self, ring: &[u32], middle: u32) {
        for i in 0..ring.len() {
            self.triangle(ring[i], ring[(i + 1) % ring.len()], middle);
        }
    }

    /// Finishes the mesh: outward orientation and smooth normals.
    pub(crate) fn into_mesh(self) -> TriangleMesh {
        let vertex = |position| Vertex {
            position,
            normal: Vector3::z(),
            color: UNPAINTED,
        };
        let triangle = |vertices| Triangle {
            vertices,
            surface: 0,
        };
        let mut mesh = TriangleMesh {
            vertices: self.points.into_iter().map(vertex).collect(),
            triangles: self.faces.into_iter().map(triangle).collect(),
            surfaces: vec![Surface::MATTE],
        };
        orient_outwards(&mut mesh);
        mesh.smooth_normals(CREASE_RAD);
        mesh
    }
}

/// Reverses all faces if the mesh is oriented inwards.
pub(crate) fn orient_outwards(mesh: &mut TriangleMesh) {
    if mesh.signed_volume() < 0.0 {
        for triangle in &mut mesh.triangles {
            triangle.vertices.swap(1, 2);
        }
    }
}
