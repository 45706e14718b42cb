//! Assignment of material colours to vertices.

use super::{MAX_VERTICES, Mesh};
use crate::ModelError;
use point_cloud::Rgba;
use std::collections::HashMap;

/// Run of triangles with one material, from its first triangle to the next run.
#[derive(Debug, Clone, Copy)]
pub(super) struct MaterialRun {
    pub(super) first_triangle: usize,
    pub(super) color: Rgba,
    /// Number of the texture, if there is one.
    pub(super) texture: Option<u32>,
}

/// Assigns the material colour of its faces to each vertex without an own colour; a vertex of
/// several colours is duplicated. The first run must start at the first triangle.
pub(super) fn assign_vertex_colors(
    mesh: &mut Mesh,
    has_own_color: &[bool],
    runs: &[MaterialRun],
) -> Result<(), ModelError> {
    let Mesh {
        vertices,
        triangles,
    } = mesh;
    let mut is_painted = has_own_color.to_vec();
    let mut copies: HashMap<(u32, u32), u32> = HashMap::new();
    let ends = runs.iter().skip(1).map(|run| run.first_triangle);
    let n_triangles = triangles.len();
    for (run, end) in runs.iter().zip(ends.chain([n_triangles])) {
        for corner in triangles[run.first_triangle..end].as_flattened_mut() {
            let vertex = *corner as usize;
            if !is_painted[vertex] {
                is_painted[vertex] = true;
                vertices[vertex].color = run.color;
            }
            if has_own_color[vertex] || vertices[vertex].color == run.color {
                continue;
            }
            if vertices.len() == MAX_VERTICES {
                return Err(ModelError::TooLarge("OBJ"));
            }
            *corner = *copies.entry((*corner, run.color.0)).or_insert_with(|| {
                let mut copy = vertices[vertex];
                copy.color = run.color;
                vertices.push(copy);
                vertices.len() as u32 - 1
            });
        }
    }
    Ok(())
}
