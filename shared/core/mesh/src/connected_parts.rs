//! The pieces of a mesh that hang together.

use crate::welding::{corner_places, places};
use crate::{Triangle, TriangleMesh};
use std::collections::HashMap;

/// Sets of places that hang together (union-find).
pub(crate) struct Parts {
    parent: Vec<u32>,
    is_used: Vec<bool>,
}

impl Parts {
    pub(crate) fn new(n: usize) -> Self {
        Self {
            parent: (0..n as u32).collect(),
            is_used: vec![false; n],
        }
    }

    /// The representative of a place's set.
    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    pub(crate) fn unite(&mut self, a: u32, b: u32) {
        self.is_used[a as usize] = true;
        self.is_used[b as usize] = true;
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a as usize] = b;
    }

    /// How many sets there are of places that were united with any.
    pub(crate) fn n_used(&self) -> usize {
        let is_root = |&i: &usize| self.is_used[i] && self.parent[i] == i as u32;
        (0..self.parent.len()).filter(is_root).count()
    }
}

impl TriangleMesh {
    /// The pieces that hang together by shared places, as meshes of their own,
    /// in the order of their first triangles. Invalid triangles are left out.
    pub fn connected_parts(&self) -> Vec<Self> {
        let (place_of_vertex, n_places) = places(self);
        let mut parts = Parts::new(n_places);
        let corners = |triangle: &Triangle| corner_places(&place_of_vertex, triangle.vertices);
        for [a, b, c] in self.triangles.iter().filter_map(corners) {
            parts.unite(a, b);
            parts.unite(b, c);
        }
        let mut known = HashMap::new();
        let mut meshes: Vec<Self> = Vec::new();
        let mut moved: HashMap<u32, u32> = HashMap::new();
        for triangle in &self.triangles {
            let Some([place, ..]) = corners(triangle) else {
                continue;
            };
            let idx = *known.entry(parts.root(place)).or_insert(meshes.len());
            if idx == meshes.len() {
                meshes.push(Self {
                    surfaces: self.surfaces.clone(),
                    ..Self::default()
                });
            }
            let mesh = &mut meshes[idx];
            let vertices = triangle.vertices.map(|i| {
                *moved.entry(i).or_insert_with(|| {
                    mesh.vertices.push(self.vertices[i as usize]);
                    mesh.vertices.len() as u32 - 1
                })
            });
            mesh.triangles.push(Triangle {
                vertices,
                ..*triangle
            });
        }
        meshes
    }
}

#[cfg(test)]
mod tests {
    use crate::{TriangleMesh, ellipsoid, rounded_box};

    #[test]
    fn what_was_joined_comes_apart() {
        let first = ellipsoid([0.02, 0.02, 0.02], 16).mesh;
        let second = rounded_box([0.1, 0.1, 0.1], 0.0, 1.0).mesh;
        let mut both = first.clone();
        both.append(&second);
        let parts = both.connected_parts();
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[0].triangles.len(), first.triangles.len());
        assert_eq!(parts[1].signed_volume(), second.signed_volume());
        assert!(parts.iter().all(|part| part.examination().is_sound()));
        assert!(TriangleMesh::default().connected_parts().is_empty());
    }
}
