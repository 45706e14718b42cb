//! Mesh validation: boundary, non-manifold and degenerate elements.

use crate::welding::{is_degenerate, weld_vertices, welded_corners};
use crate::{Bounds, TriangleMesh};
use std::collections::{HashMap, HashSet};
use union_find::{find_root, union};

/// Area below which a triangle counts as degenerate, square metres. Chosen.
const AREA_MIN_M2: f32 = 1e-12;

/// Result of mesh validation. Vertices at equal positions are treated as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshDiagnostics {
    /// Number of boundary edges: edges with a single face.
    pub n_boundary_edges: usize,
    /// Number of non-manifold edges: edges with more than two faces.
    pub n_non_manifold_edges: usize,
    /// Number of edges whose two faces have inconsistent orientation.
    pub n_inconsistent_edges: usize,
    /// Number of degenerate triangles: coincident or collinear corners.
    pub n_degenerate_triangles: usize,
    /// Number of triangles that refer to a missing vertex or surface.
    pub n_invalid_triangles: usize,
    /// Number of vertices whose position or normal is not finite.
    pub n_non_finite_vertices: usize,
    /// Number of connected components.
    pub n_components: usize,
    /// Bounding box of the mesh's finite vertices.
    pub extent: Option<Bounds>,
}

impl MeshDiagnostics {
    /// True if the mesh is closed (watertight): each edge belongs to exactly two faces.
    pub fn is_closed(&self) -> bool {
        self.n_boundary_edges == 0 && self.n_non_manifold_edges == 0 && self.n_components > 0
    }

    /// True if the mesh is closed and has no other defect.
    pub fn is_sound(&self) -> bool {
        self.is_closed()
            && self.n_inconsistent_edges == 0
            && self.n_degenerate_triangles == 0
            && self.n_invalid_triangles == 0
            && self.n_non_finite_vertices == 0
    }
}

/// Number of uses of an edge in either direction.
#[derive(Default)]
struct EdgeUse {
    n_forward: usize,
    n_backward: usize,
}

impl TriangleMesh {
    /// Validates the mesh. Any mesh is accepted.
    pub fn diagnostics(&self) -> MeshDiagnostics {
        let (welded_index, n_welded) = weld_vertices(self);
        let mut edges: HashMap<(u32, u32), EdgeUse> = HashMap::new();
        let mut parents: Vec<u32> = (0..n_welded as u32).collect();
        let (mut n_degenerate, mut n_invalid) = (0, 0);
        for (i, triangle) in self.triangles.iter().enumerate() {
            let corners = welded_corners(&welded_index, triangle.vertices);
            let Some(corners) =
                corners.filter(|_| usize::from(triangle.surface) < self.surfaces.len())
            else {
                n_invalid += 1;
                continue;
            };
            n_degenerate += usize::from(is_degenerate(corners) || self.is_flat(i));
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let edge = edges.entry((a.min(b), a.max(b))).or_default();
                *(if a < b {
                    &mut edge.n_forward
                } else {
                    &mut edge.n_backward
                }) += 1;
                union(&mut parents, a, b);
            }
        }
        let roots: HashSet<u32> = edges
            .keys()
            .map(|&(corner, _)| find_root(&mut parents, corner))
            .collect();
        let count = |is: fn(&EdgeUse) -> bool| edges.values().filter(|edge| is(edge)).count();
        MeshDiagnostics {
            n_boundary_edges: count(|edge| edge.n_forward + edge.n_backward == 1),
            n_non_manifold_edges: count(|edge| edge.n_forward + edge.n_backward > 2),
            n_inconsistent_edges: count(|edge| edge.n_forward.abs_diff(edge.n_backward) == 2),
            n_degenerate_triangles: n_degenerate,
            n_invalid_triangles: n_invalid,
            n_non_finite_vertices: self.n_non_finite_vertices(),
            n_components: roots.len(),
            extent: self.bounds(),
        }
    }

    fn is_flat(&self, triangle_idx: usize) -> bool {
        self.corners(triangle_idx).is_some_and(|[a, b, c]| {
            // Corners that are not finite are counted separately.
            (b - a).cross(&(c - a)).norm() / 2.0 < AREA_MIN_M2
        })
    }

    fn n_non_finite_vertices(&self) -> usize {
        let bad = |vertex: &&crate::Vertex| {
            let mut numbers = vertex.position.iter().chain(vertex.normal.iter());
            !numbers.all(|x| x.is_finite())
        };
        self.vertices.iter().filter(bad).count()
    }
}

#[cfg(test)]
mod tests {
    use crate::{TriangleMesh, rounded_box};
    use nalgebra::Point3;

    fn cube() -> TriangleMesh {
        rounded_box([0.1, 0.1, 0.1], 0.0, 1.0).mesh
    }

    #[test]
    fn a_cube_is_sound() {
        let found = cube().diagnostics();
        assert!(found.is_sound(), "{found:?}");
        assert_eq!(found.n_components, 1);
    }

    #[test]
    fn a_missing_face_leaves_three_boundary_edges() {
        let mut mesh = cube();
        mesh.triangles.pop();
        let found = mesh.diagnostics();
        assert_eq!(found.n_boundary_edges, 3);
        assert!(!found.is_closed());
    }

    #[test]
    fn a_turned_face_is_inconsistent_with_its_three_neighbours() {
        let mut mesh = cube();
        mesh.triangles[0].vertices.swap(0, 1);
        let found = mesh.diagnostics();
        assert_eq!((found.n_inconsistent_edges, found.n_boundary_edges), (3, 0));
        assert!(!found.is_sound());
    }

    #[test]
    fn doubled_collapsed_and_invalid_faces_are_counted() {
        let mut mesh = cube();
        let first = mesh.triangles[0];
        mesh.triangles.push(first);
        mesh.triangles.push(crate::Triangle {
            vertices: [0, 0, 1],
            ..first
        });
        mesh.triangles.push(crate::Triangle {
            vertices: [0, 1, 999],
            ..first
        });
        mesh.vertices[0].normal.x = f32::NAN;
        let found = mesh.diagnostics();
        assert!(found.n_non_manifold_edges >= 3);
        assert_eq!(
            (
                found.n_degenerate_triangles,
                found.n_invalid_triangles,
                found.n_non_finite_vertices
            ),
            (1, 1, 1)
        );
    }

    #[test]
    fn separate_parts_are_counted() {
        let mut mesh = cube();
        let mut other = cube();
        for vertex in &mut other.vertices {
            vertex.position += Point3::new(1.0, 0.0, 0.0).coords;
        }
        mesh.append(&other);
        assert_eq!(mesh.diagnostics().n_components, 2);
        assert_eq!(TriangleMesh::default().diagnostics().n_components, 0);
    }
}
