//! Which vertices lie at the same place.

use crate::TriangleMesh;
use nalgebra::Point3;
use std::collections::HashMap;

/// Same bits for the same place: negative zero is zero.
fn key(position: &Point3<f32>) -> [u32; 3] {
    [position.x, position.y, position.z].map(|x| (x + 0.0).to_bits())
}

/// For each vertex the number of its place, counted in the order of first
/// occurrence, and how many places there are.
pub(crate) fn places(mesh: &TriangleMesh) -> (Vec<u32>, usize) {
    let mut known = HashMap::with_capacity(mesh.vertices.len());
    let place_of_vertex = mesh
        .vertices
        .iter()
        .map(|vertex| {
            let next = known.len() as u32;
            *known.entry(key(&vertex.position)).or_insert(next)
        })
        .collect();
    (place_of_vertex, known.len())
}

/// The places of a triangle's corners; `None` when a corner does not exist.
pub(crate) fn corner_places(place_of_vertex: &[u32], vertices: [u32; 3]) -> Option<[u32; 3]> {
    let at = |i: u32| place_of_vertex.get(i as usize).copied();
    let [a, b, c] = vertices;
    Some([at(a)?, at(b)?, at(c)?])
}

/// Whether two corners fall together.
pub(crate) fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
