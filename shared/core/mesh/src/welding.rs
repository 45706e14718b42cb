//! Vertex welding: vertices at equal positions are treated as one.

use crate::TriangleMesh;
use nalgebra::Point3;
use std::collections::HashMap;

/// Hash key of a position: equal bits for equal positions, negative zero included.
fn key(position: &Point3<f32>) -> [u32; 3] {
    [position.x, position.y, position.z].map(|x| (x + 0.0).to_bits())
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
