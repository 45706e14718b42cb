//! The colours of materials on the vertices of their faces.

use super::{Error, MAX_VERTICES, Mesh};
use point_cloud::Rgba;
use std::collections::HashMap;

/// The triangles from this one on have this colour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) first_triangle: usize,
    pub(super) color: Rgba,
}

/// Gives each vertex without an own colour that of its faces; a vertex of
/// several colours becomes several vertices. The first run begins with the
/// first triangle.
pub(super) fn paint(mesh: &mut Mesh, has_own_color: &[bool], runs: &[Run]) -> Result<(), Error> {
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
                return Err(Error::TooLarge);
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
