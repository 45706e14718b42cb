//! Marching cubes: the surface of a signed distance field as a triangle mesh.

use crate::cube_cases::{EDGES, cases};
use crate::surface_points::{crossing, following, voxel_at, voxel_places};
use crate::tsdf_volume::TsdfVolume;
use crate::voxel_block::{BLOCK_SIDE, Block, Voxel};
use mesh::{Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::Vector3;
use std::collections::HashMap;

/// Share of the area of the largest piece that a piece of the surface needs. Chosen: stray
/// surfaces are far smaller, and no object falls into pieces.
const PIECE_SHARE_MIN: f64 = 0.05;

/// Edge of the voxel grid: the coordinates of its lower voxel, and its axis.
type GridEdge = ([i32; 3], usize);

impl TsdfVolume {
    /// Coloured mesh of the surface, where it was seen with a weight at least, without small
    /// loose pieces (Lorensen and Cline 1987).
    pub(crate) fn mesh(&self, weight_min: f32) -> TriangleMesh {
        let mut mesh = TriangleMesh {
            surfaces: vec![Surface::MATTE],
            ..TriangleMesh::default()
        };
        let mut vertices: HashMap<GridEdge, u32> = HashMap::new();
        for block in self.blocks() {
            let blocks = following(self, block);
            for place in voxel_places() {
                self.add_cube(
                    &mut mesh,
                    &mut vertices,
                    &blocks,
                    (block, place),
                    weight_min,
                );
            }
        }
        let mut mesh = largest_pieces(&mesh);
        set_normals(&mut mesh);
        mesh
    }

    /// Adds the triangles of the cube between a voxel and its seven followers.
    fn add_cube(
        &self,
        mesh: &mut TriangleMesh,
        vertices: &mut HashMap<GridEdge, u32>,
        blocks: &[Option<&Block>; 8],
        (block, place): (&Block, [usize; 3]),
        weight_min: f32,
    ) {
        let Some(corners) = corners(blocks, place, weight_min) else {
            return;
        };
        let is_inside = |corner: &usize| corners[*corner].distance_m < 0.0;
        let case = (0..8)
            .filter(is_inside)
            .fold(0, |case, corner| case | 1 << corner);
        for triangle in &cases()[case] {
            let corner_vertices = triangle.map(|edge| {
                let edge = EDGES[edge];
                let lower = std::array::from_fn(|axis| place[axis] + (edge.corner >> axis & 1));
                let grid: [i32; 3] = std::array::from_fn(|axis| {
                    block.place[axis] * BLOCK_SIDE as i32 + lower[axis] as i32
                });
                *vertices.entry((grid, edge.axis)).or_insert_with(|| {
                    let (from, to) = (corners[edge.corner], corners[edge.corner | 1 << edge.axis]);
                    let found = crossing(from, to, weight_min);
                    let mut position = self.voxel_centre(block, lower);
                    position[edge.axis] += self.voxel_m() * found.map_or(0.5, |f| f.share);
                    mesh.vertices.push(Vertex {
                        position,
                        normal: Vector3::zeros(),
                        color: found.map_or([128; 3], |f| f.color),
                    });
                    mesh.vertices.len() as u32 - 1
                })
            });
            mesh.triangles.push(Triangle {
                vertices: corner_vertices,
                surface: 0,
            });
        }
    }
}

/// Voxels at the corners of a cube; `None` if one of them was not seen.
fn corners<'a>(
    blocks: &[Option<&'a Block>; 8],
    place: [usize; 3],
    weight_min: f32,
) -> Option<[&'a Voxel; 8]> {
    let own = voxel_at(blocks, place).filter(|voxel| voxel.weight >= weight_min)?;
    let mut corners = [own; 8];
    for (bits, corner) in corners.iter_mut().enumerate().skip(1) {
        let at = std::array::from_fn(|axis| place[axis] + (bits >> axis & 1));
        *corner = voxel_at(blocks, at).filter(|voxel| voxel.weight >= weight_min)?;
    }
    Some(corners)
}

/// Pieces of a mesh that are large enough, as one mesh.
fn largest_pieces(mesh: &TriangleMesh) -> TriangleMesh {
    let pieces = mesh.connected_components();
    let areas: Vec<f64> = pieces.iter().map(TriangleMesh::surface_area).collect();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    let mut kept = TriangleMesh {
        surfaces: vec![Surface::MATTE],
        ..TriangleMesh::default()
    };
    for (piece, area) in pieces.iter().zip(areas) {
        if area >= PIECE_SHARE_MIN * largest {
            kept.append(piece);
        }
    }
    kept
}

/// Sets the normals of the vertices to the mean of those of their triangles by area.
fn set_normals(mesh: &mut TriangleMesh) {
    let mut sums = vec![Vector3::<f32>::zeros(); mesh.vertices.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle
            .vertices
            .map(|v| mesh.vertices[v as usize].position);
        let area = (b - a).cross(&(c - a));
        for vertex in triangle.vertices {
            sums[vertex as usize] += area;
        }
    }
    for (vertex, sum) in mesh.vertices.iter_mut().zip(sums) {
        vertex.normal = sum.try_normalize(0.0).unwrap_or_else(Vector3::z);
    }
}
