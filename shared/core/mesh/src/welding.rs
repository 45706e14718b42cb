//! Vertex welding: vertices at equal positions are treated as one, or become one.

use crate::TriangleMesh;
use nalgebra::Point3;
use std::collections::HashMap;

/// Hash key of a position: equal bits for equal positions, negative zero included.
fn key(position: &Point3<f32>) -> [u32; 3] {
    [position.x, position.y, position.z].map(|x| (x + 0.0).to_bits())
}

impl TriangleMesh {
    /// Merges vertices of equal position and colour and drops those without a face. Seams between
    /// colours stay. The merged vertex has the normal of the first one.
    pub fn weld(&mut self) {
        let mut known = HashMap::with_capacity(self.vertices.len());
        let mut vertices = Vec::new();
        for corner in self.triangles.iter_mut().flat_map(|t| &mut t.vertices) {
            // A corner without a vertex stays without one.
            let Some(vertex) = self.vertices.get(*corner as usize) else {
                *corner = u32::MAX;
                continue;
            };
            let key = (key(&vertex.position), vertex.color);
            *corner = *known.entry(key).or_insert_with(|| {
                vertices.push(*vertex);
                vertices.len() as u32 - 1
            });
        }
        self.vertices = vertices;
    }
}

/// Index of the welded vertex for each vertex, in the order of first occurrence, and the number
/// of welded vertices.
pub(crate) fn weld_vertices(mesh: &TriangleMesh) -> (Vec<u32>, usize) {
    let mut known = HashMap::with_capacity(mesh.vertices.len());
    let welded_index = mesh
        .vertices
        .iter()
        .map(|vertex| {
            let next = known.len() as u32;
            *known.entry(key(&vertex.position)).or_insert(next)
        })
        .collect();
    (welded_index, known.len())
}

/// Welded vertices of a triangle's corners; `None` for an invalid index.
pub(crate) fn welded_corners(welded_index: &[u32], vertices: [u32; 3]) -> Option<[u32; 3]> {
    let at = |i: u32| welded_index.get(i as usize).copied();
    let [a, b, c] = vertices;
    Some([at(a)?, at(b)?, at(c)?])
}

/// True if two corners of the triangle coincide.
pub(crate) fn is_degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

#[cfg(test)]
mod tests {
    use crate::{Triangle, TriangleMesh, rounded_box};

    /// Mesh whose triangles share no vertices.
    fn soup(mesh: &TriangleMesh) -> TriangleMesh {
        let corners = mesh.triangles.iter().flat_map(|t| t.vertices);
        TriangleMesh {
            vertices: corners.map(|i| mesh.vertices[i as usize]).collect(),
            triangles: (0..mesh.triangles.len() as u32)
                .map(|i| Triangle {
                    vertices: [3 * i, 3 * i + 1, 3 * i + 2],
                    surface: 0,
                })
                .collect(),
            surfaces: mesh.surfaces.clone(),
        }
    }

    #[test]
    fn welding_joins_a_soup_and_keeps_seams_of_colour() {
        let cube = rounded_box([0.1, 0.2, 0.3], 0.0, 1.0).mesh;
        let mut mesh = soup(&cube);
        assert_eq!(mesh.vertices.len(), 36);
        mesh.weld();
        assert_eq!(mesh.vertices.len(), 8);
        assert!(mesh.diagnostics().is_sound());
        assert!((mesh.signed_volume() - 0.006).abs() < 1e-8);
        let mut mesh = soup(&cube);
        for vertex in &mut mesh.vertices[..3] {
            vertex.color = [255, 0, 0];
        }
        mesh.weld();
        assert_eq!(mesh.vertices.len(), 8 + 3);
    }

    #[test]
    fn welding_keeps_invalid_corners_invalid() {
        let mut mesh = rounded_box([0.1, 0.1, 0.1], 0.0, 1.0).mesh;
        mesh.triangles[2].vertices[1] = 1000;
        mesh.weld();
        assert_eq!(mesh.diagnostics().n_invalid_triangles, 1);
    }
}
