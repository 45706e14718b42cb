//! Vertex normals from face normals, with creases.

use crate::welding::{weld_vertices, welded_corners};
use crate::{Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, Vector3};

impl TriangleMesh {
    /// Recomputes the vertex normals: at each corner the mean of the adjacent face normals,
    /// weighted by corner angle (Thürmer and Wüthrich 1998), over the faces whose normals differ by
    /// less than `crease_rad` from the corner's own face. Vertices at equal positions are merged
    /// and split along creases; colours and surfaces are kept. Invalid triangles are dropped.
    pub fn smooth_normals(&mut self, crease_rad: f32) {
        let (welded_index, n_welded) = weld_vertices(self);
        self.triangles
            .retain(|triangle| welded_corners(&welded_index, triangle.vertices).is_some());
        let faces: Vec<Face> = (0..self.triangles.len())
            .filter_map(|i| self.corners(i))
            .map(Face::of)
            .collect();
        let vertex_faces = VertexFaces::new(self, &welded_index, n_welded);
        let cos_crease = crease_rad.cos();
        let mut split = VertexSplitter::new(n_welded);
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for (i, triangle) in self.triangles.iter().enumerate() {
            let vertices = triangle.vertices.map(|vertex_idx| {
                let welded = welded_index[vertex_idx as usize];
                let normal = vertex_faces.normal(welded, &faces, i, cos_crease);
                let vertex = self.vertices[vertex_idx as usize];
                split.index_of(welded, Vertex { normal, ..vertex })
            });
            triangles.push(Triangle {
                vertices,
                ..*triangle
            });
        }
        self.triangles = triangles;
        self.vertices = split.vertices;
    }
}

/// Unit normal and corner angles of a face.
struct Face {
    normal: Vector3<f32>,
    angles: [f32; 3],
}

impl Face {
    fn of(corners: [Point3<f32>; 3]) -> Self {
        let [a, b, c] = corners;
        let angle = |p: Point3<f32>, q: Point3<f32>, r: Point3<f32>| (q - p).angle(&(r - p));
        Self {
            normal: unit((b - a).cross(&(c - a))),
            angles: [angle(a, b, c), angle(b, c, a), angle(c, a, b)],
        }
    }
}

fn unit(v: Vector3<f32>) -> Vector3<f32> {
    v.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}

/// Incidence list: `(face, corner)` of each welded vertex, flattened.
struct VertexFaces {
    first: Vec<u32>,
    corners: Vec<(u32, u8)>,
}

impl VertexFaces {
    fn new(mesh: &TriangleMesh, welded_index: &[u32], n_welded: usize) -> Self {
        let mut first = vec![0; n_welded + 1];
        let all = || {
            mesh.triangles.iter().enumerate().flat_map(|(i, triangle)| {
                (0..3_u8).map(move |k| {
                    let vertex = triangle.vertices[usize::from(k)];
                    (welded_index[vertex as usize] as usize, (i as u32, k))
                })
            })
        };
        for (welded, _) in all() {
            first[welded + 1] += 1;
        }
        for welded in 0..n_welded {
            first[welded + 1] += first[welded];
        }
        let mut next = first.clone();
        let mut corners = vec![(0, 0); first[n_welded] as usize];
        for (welded, corner) in all() {
            corners[next[welded] as usize] = corner;
            next[welded] += 1;
        }
        Self { first, corners }
    }

    fn normal(
        &self,
        welded: u32,
        faces: &[Face],
        face_idx: usize,
        cos_crease: f32,
    ) -> Vector3<f32> {
        let own = faces[face_idx].normal;
        let range = self.first[welded as usize] as usize..self.first[welded as usize + 1] as usize;
        let sum: Vector3<f32> = self.corners[range]
            .iter()
            .map(|&(face, k)| (&faces[face as usize], usize::from(k)))
            .filter(|(face, _)| face.normal.dot(&own) > cos_crease)
            .map(|(face, k)| face.normal * face.angles[k])
            .sum();
        sum.try_normalize(1e-12)
            .or_else(|| own.try_normalize(1e-12))
            .unwrap_or_else(Vector3::z)
    }
}

const NONE: u32 = u32::MAX;

/// Vertices that differ in position, normal or colour, as linked lists per welded vertex.
struct VertexSplitter {
    first_at_welded: Vec<u32>,
    next_at_welded: Vec<u32>,
    vertices: Vec<Vertex>,
}

impl VertexSplitter {
    fn new(n_welded: usize) -> Self {
        Self {
            first_at_welded: vec![NONE; n_welded],
            next_at_welded: Vec::new(),
            vertices: Vec::new(),
        }
    }

    fn index_of(&mut self, welded: u32, vertex: Vertex) -> u32 {
        let first = self.first_at_welded[welded as usize];
        let mut idx = first;
        while idx != NONE {
            let known = &self.vertices[idx as usize];
            if known.normal == vertex.normal && known.color == vertex.color {
                return idx;
            }
            idx = self.next_at_welded[idx as usize];
        }
        let fresh = self.vertices.len() as u32;
        self.vertices.push(vertex);
        self.next_at_welded.push(first);
        self.first_at_welded[welded as usize] = fresh;
        fresh
    }
}

#[cfg(test)]
mod tests {
    use crate::{ellipsoid, rounded_box};

    #[test]
    fn a_cube_keeps_its_edges_below_the_crease_angle_only() {
        let mut mesh = rounded_box([0.1, 0.1, 0.1], 0.0, 1.0).mesh;
        mesh.smooth_normals(0.7);
        assert_eq!(mesh.vertices.len(), 24);
        mesh.smooth_normals(3.0);
        assert_eq!(mesh.vertices.len(), 8);
        for vertex in &mesh.vertices {
            let outwards = vertex.position.coords.normalize();
            assert!(vertex.normal.dot(&outwards) > 0.999, "weighted by angle");
        }
    }

    #[test]
    fn a_sphere_looks_outwards() {
        for vertex in &ellipsoid([0.05, 0.05, 0.05], 32).mesh.vertices {
            assert!(vertex.normal.dot(&vertex.position.coords.normalize()) > 0.99);
        }
    }
}
