//! Vertex normals from faces.

use crate::welding::{corner_places, places};
use crate::{Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, Vector3};

impl TriangleMesh {
    /// Gives the mesh new normals: at each corner the mean of the normals of
    /// the faces around it, weighted by their angle there (Thürmer and Wüthrich
    /// 1998), as far as these differ by less than `crease_rad` from the corner's
    /// own face. Vertices at equal positions are taken as one and split anew
    /// along creases; colours and surfaces stay. Invalid triangles are dropped.
    pub fn smooth_normals(&mut self, crease_rad: f32) {
        let (place_of_vertex, n_places) = places(self);
        self.triangles
            .retain(|triangle| corner_places(&place_of_vertex, triangle.vertices).is_some());
        let faces: Vec<Face> = (0..self.triangles.len())
            .filter_map(|i| self.corners(i))
            .map(Face::of)
            .collect();
        let around = Around::new(self, &place_of_vertex, n_places);
        let cos_crease = crease_rad.cos();
        let mut split = Splitting::new(n_places);
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for (i, triangle) in self.triangles.iter().enumerate() {
            let vertices = triangle.vertices.map(|vertex_idx| {
                let place = place_of_vertex[vertex_idx as usize];
                let normal = around.normal(place, &faces, i, cos_crease);
                let vertex = self.vertices[vertex_idx as usize];
                split.index_of(place, Vertex { normal, ..vertex })
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

/// Unit normal and angles at the corners.
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

/// The corners at each place: `(face, corner)`, flattened.
struct Around {
    first: Vec<u32>,
    corners: Vec<(u32, u8)>,
}

impl Around {
    fn new(mesh: &TriangleMesh, place_of_vertex: &[u32], n_places: usize) -> Self {
        let mut first = vec![0; n_places + 1];
        let all = || {
            mesh.triangles.iter().enumerate().flat_map(|(i, triangle)| {
                (0..3_u8).map(move |k| {
                    let vertex = triangle.vertices[usize::from(k)];
                    (place_of_vertex[vertex as usize] as usize, (i as u32, k))
                })
            })
        };
        for (place, _) in all() {
            first[place + 1] += 1;
        }
        for place in 0..n_places {
            first[place + 1] += first[place];
        }
        let mut next = first.clone();
        let mut corners = vec![(0, 0); first[n_places] as usize];
        for (place, corner) in all() {
            corners[next[place] as usize] = corner;
            next[place] += 1;
        }
        Self { first, corners }
    }

    fn normal(&self, place: u32, faces: &[Face], face_idx: usize, cos_crease: f32) -> Vector3<f32> {
        let own = faces[face_idx].normal;
        let range = self.first[place as usize] as usize..self.first[place as usize + 1] as usize;
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

/// Vertices that differ in place, normal or colour, chained by place.
struct Splitting {
    first_at_place: Vec<u32>,
    next_at_place: Vec<u32>,
    vertices: Vec<Vertex>,
}

impl Splitting {
    fn new(n_places: usize) -> Self {
        Self {
            first_at_place: vec![NONE; n_places],
            next_at_place: Vec::new(),
            vertices: Vec::new(),
        }
    }

    fn index_of(&mut self, place: u32, vertex: Vertex) -> u32 {
        let first = self.first_at_place[place as usize];
        let mut idx = first;
        while idx != NONE {
            let known = &self.vertices[idx as usize];
            if known.normal == vertex.normal && known.color == vertex.color {
                return idx;
            }
            idx = self.next_at_place[idx as usize];
        }
        let fresh = self.vertices.len() as u32;
        self.vertices.push(vertex);
        self.next_at_place.push(first);
        self.first_at_place[place as usize] = fresh;
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
