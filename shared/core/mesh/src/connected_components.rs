//! Connected components of a mesh.

use crate::welding::{weld_vertices, welded_corners};
use crate::{Triangle, TriangleMesh};
use std::collections::HashMap;
use union_find::{find_root, union};

impl TriangleMesh {
    /// Splits the mesh into its connected components by shared vertex positions, in the order of
    /// their first triangles. Invalid triangles are dropped.
    pub fn connected_components(&self) -> Vec<Self> {
        let (welded_index, n_welded) = weld_vertices(self);
        let mut parents: Vec<u32> = (0..n_welded as u32).collect();
        let corners = |triangle: &Triangle| welded_corners(&welded_index, triangle.vertices);
        for [a, b, c] in self.triangles.iter().filter_map(corners) {
            union(&mut parents, a, b);
            union(&mut parents, b, c);
        }
        let mut known = HashMap::new();
        let mut meshes: Vec<Self> = Vec::new();
        let mut moved: HashMap<u32, u32> = HashMap::new();
        for triangle in &self.triangles {
            let Some([place, ..]) = corners(triangle) else {
                continue;
            };
            let idx = *known
                .entry(find_root(&mut parents, place))
                .or_insert(meshes.len());
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
    fn joined_meshes_come_apart() {
        let first = ellipsoid([0.02, 0.02, 0.02], 16).mesh;
        let second = rounded_box([0.1, 0.1, 0.1], 0.0, 1.0).mesh;
        let mut both = first.clone();
        both.append(&second);
        let parts = both.connected_components();
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[0].triangles.len(), first.triangles.len());
        assert_eq!(parts[1].signed_volume(), second.signed_volume());
        assert!(parts.iter().all(|part| part.diagnostics().is_sound()));
        assert!(TriangleMesh::default().connected_components().is_empty());
    }
}
