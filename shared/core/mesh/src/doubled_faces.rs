//! Removal of doubled faces: triangles with the same three corners in the same orientation.

use crate::decimation::canonical_order;
use crate::welding::{is_degenerate, weld_vertices, welded_corners};
use crate::{Triangle, TriangleMesh};
use std::collections::HashSet;

impl TriangleMesh {
    /// Drops faces that repeat the corners of an earlier face in any rotation, and returns their
    /// number. Vertices at equal positions are treated as one.
    ///
    /// A face in the other orientation stays: it shows the surface from its other side, since a
    /// face is seen from its front only, and it cannot be told which side is seen.
    pub fn drop_doubled_faces(&mut self) -> usize {
        let n_before = self.triangles.len();
        let (welded_index, _) = weld_vertices(self);
        let mut known = HashSet::with_capacity(n_before);
        self.triangles.retain(|Triangle { vertices, .. }| {
            let corners = welded_corners(&welded_index, *vertices);
            let corners = corners.filter(|&corners| !is_degenerate(corners));
            corners.is_none_or(|corners| known.insert(canonical_order(corners)))
        });
        n_before - self.triangles.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ellipsoid;

    fn ball() -> TriangleMesh {
        ellipsoid([0.05, 0.04, 0.03], 24).mesh
    }

    /// Mesh with a second copy of each face, chosen by its number.
    fn doubled(mesh: &TriangleMesh, copy: impl Fn(usize, Triangle) -> Triangle) -> TriangleMesh {
        let mut doubled = mesh.clone();
        let copies = mesh.triangles.iter().enumerate();
        doubled.triangles.extend(copies.map(|(i, t)| copy(i, *t)));
        doubled
    }

    fn turned_over(triangle: Triangle) -> Triangle {
        let [a, b, c] = triangle.vertices;
        Triangle {
            vertices: [a, c, b],
            ..triangle
        }
    }

    #[test]
    fn doubled_faces_of_one_orientation_are_dropped() {
        let ball = ball();
        let mut twice = doubled(&ball, |i, triangle| {
            let mut vertices = triangle.vertices;
            vertices.rotate_left(i % 3);
            Triangle {
                vertices,
                ..triangle
            }
        });
        assert!(!twice.diagnostics().is_closed());
        assert_eq!(twice.drop_doubled_faces(), ball.triangles.len());
        assert_eq!(twice, ball);
    }

    #[test]
    fn doubled_faces_of_both_orientations_keep_both_sides() {
        let ball = ball();
        let both = doubled(&ball, |_, triangle| turned_over(triangle));
        let mut twice = both.clone();
        twice.triangles.extend_from_within(..);
        assert_eq!(twice.drop_doubled_faces(), both.triangles.len());
        assert_eq!(twice, both);
    }

    #[test]
    fn doubled_faces_of_a_broken_mesh_are_dropped() {
        let mut mesh = ball();
        mesh.vertices[7].position.x = f32::NAN;
        mesh.triangles[3].vertices[1] = u32::MAX;
        mesh.triangles[5].vertices = [1, 1, 1];
        let mut twice = doubled(&mesh, |_, triangle| triangle);
        twice.drop_doubled_faces();
        assert!(twice.triangles.len() >= mesh.triangles.len());
        assert_eq!(TriangleMesh::default().drop_doubled_faces(), 0);
    }
}
