//! Removal of doubled faces: triangles with the same three corners.

use crate::decimation::canonical_order;
use crate::union_find::UnionFind;
use crate::welding::{is_degenerate, weld_vertices, welded_corners};
use crate::{Triangle, TriangleMesh};
use nalgebra::Vector3;
use std::collections::HashMap;

/// Greatest square of the length of a rim, as a share of the area of the surface, at which a
/// surface counts as closed but for a hole. That is a round hole of a sixth of the radius of a
/// ball; a hemisphere has 6.3. Chosen.
const RIM_SHARE: f32 = 0.1;

/// Numbers of doubled faces of a mesh. Vertices at equal positions are treated as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DoubledFaces {
    /// Number of faces that were dropped.
    pub n_dropped: usize,
    /// Number of faces whose other side was kept, because they enclose no volume.
    pub n_two_sided: usize,
}

impl TriangleMesh {
    /// Drops faces that repeat the corners of an earlier face, in any rotation.
    ///
    /// A face in both orientations shows a surface from both sides. Around a volume nobody sees
    /// the inner side: one face is kept, and turned outwards. Of an open sheet, and where more
    /// than two faces meet at edges, both sides are kept: it cannot be told which of them is
    /// seen, and a face is seen from its front only.
    pub fn drop_doubled_faces(&mut self) -> DoubledFaces {
        let n_before = self.triangles.len();
        let faces = distinct_faces(self);
        let mut n_two_sided = 0;
        if faces.iter().any(|face| face.twin.is_some()) {
            let edges = edge_uses(self, &faces);
            let is_open = open_faces(self, &faces, &edges);
            let is_flipped = flipped_faces(self, &faces, &edges, &is_open);
            let mut triangles = Vec::with_capacity(n_before);
            for (idx, face) in faces.iter().enumerate() {
                let triangle = self.triangles[face.triangle];
                triangles.push(if is_flipped[idx] {
                    turned_over(triangle)
                } else {
                    triangle
                });
                if let Some(twin) = face.twin.filter(|_| is_open[idx]) {
                    triangles.push(self.triangles[twin]);
                    n_two_sided += 1;
                }
            }
            self.triangles = triangles;
        } else if faces.len() < n_before {
            let kept = faces.iter().map(|face| self.triangles[face.triangle]);
            self.triangles = kept.collect();
        }
        DoubledFaces {
            n_dropped: n_before - self.triangles.len(),
            n_two_sided,
        }
    }
}

fn turned_over(triangle: Triangle) -> Triangle {
    let [a, b, c] = triangle.vertices;
    Triangle {
        vertices: [a, c, b],
        ..triangle
    }
}

/// Face of a triangle that is the first one with its corners.
struct Face {
    triangle: usize,
    /// First triangle with the same corners in the other orientation.
    twin: Option<usize>,
    /// Welded corners; `None` for an invalid or degenerate triangle.
    corners: Option<[u32; 3]>,
}

/// First triangle of each set of corners, in the order of the mesh.
fn distinct_faces(mesh: &TriangleMesh) -> Vec<Face> {
    let (welded_index, _) = weld_vertices(mesh);
    let mut faces: Vec<Face> = Vec::with_capacity(mesh.triangles.len());
    let mut known: HashMap<[u32; 3], usize> = HashMap::with_capacity(mesh.triangles.len());
    for (triangle, Triangle { vertices, .. }) in mesh.triangles.iter().enumerate() {
        let corners =
            welded_corners(&welded_index, *vertices).filter(|&corners| !is_degenerate(corners));
        if let Some(corners) = corners {
            let mut sorted = corners;
            sorted.sort_unstable();
            let idx = *known.entry(sorted).or_insert(faces.len());
            if let Some(face) = faces.get_mut(idx) {
                if face.corners.map(canonical_order) != Some(canonical_order(corners)) {
                    face.twin.get_or_insert(triangle);
                }
                continue;
            }
        }
        faces.push(Face {
            triangle,
            twin: None,
            corners,
        });
    }
    faces
}

/// Uses of one edge.
struct EdgeUses {
    /// Faces at the edge; `true` for the direction from the lesser to the greater vertex.
    faces: Vec<(usize, bool)>,
    length: f32,
}

fn edge_uses(mesh: &TriangleMesh, faces: &[Face]) -> Vec<EdgeUses> {
    let mut uses: Vec<EdgeUses> = Vec::new();
    let mut known: HashMap<(u32, u32), usize> = HashMap::new();
    for (idx, face) in faces.iter().enumerate() {
        let (Some(corners), Some(positions)) = (face.corners, mesh.corners(face.triangle)) else {
            continue;
        };
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (a, b) = (corners[k], corners[next]);
            let edge = *known.entry((a.min(b), a.max(b))).or_insert(uses.len());
            if edge == uses.len() {
                uses.push(EdgeUses {
                    faces: Vec::with_capacity(2),
                    length: (positions[next] - positions[k]).norm(),
                });
            }
            uses[edge].faces.push((idx, a < b));
        }
    }
    uses
}

/// True for each face of a patch with a long rim. Faces at an edge of two belong to one patch; an
/// edge of one face, or of several, is rim.
fn open_faces(mesh: &TriangleMesh, faces: &[Face], edges: &[EdgeUses]) -> Vec<bool> {
    let mut parts = UnionFind::new(faces.len());
    for edge in edges {
        if let [(a, _), (b, _)] = edge.faces[..] {
            parts.union(a as u32, b as u32);
        }
    }
    let mut part = |face: usize| parts.find(face as u32) as usize;
    let (mut rims, mut areas) = (vec![0.0; faces.len()], vec![0.0; faces.len()]);
    for edge in edges {
        if edge.faces.len() != 2 {
            for &(face, _) in &edge.faces {
                rims[part(face)] += edge.length;
            }
        }
    }
    for (idx, face) in faces.iter().enumerate() {
        if let Some([a, b, c]) = mesh.corners(face.triangle) {
            areas[part(idx)] += (b - a).cross(&(c - a)).norm() / 2.0;
        }
    }
    let is_open = |face: usize| {
        let part = part(face);
        rims[part] * rims[part] > RIM_SHARE * areas[part]
    };
    (0..faces.len()).map(is_open).collect()
}

/// True for each face that is to be turned over, so that its closed patch looks outwards: only
/// faces with a twin.
fn flipped_faces(
    mesh: &TriangleMesh,
    faces: &[Face],
    edges: &[EdgeUses],
    is_open: &[bool],
) -> Vec<bool> {
    // Neighbours of each face, and `true` if they agree as they are.
    let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); faces.len()];
    for edge in edges {
        if let [(a, a_is_forward), (b, b_is_forward)] = edge.faces[..] {
            neighbours[a].push((b, a_is_forward != b_is_forward));
            neighbours[b].push((a, a_is_forward != b_is_forward));
        }
    }
    let mut is_flipped = vec![false; faces.len()];
    let mut is_settled = is_open.to_vec();
    for first in 0..faces.len() {
        if is_settled[first] {
            continue;
        }
        is_settled[first] = true;
        let mut patch = vec![first];
        spread(&mut patch, &neighbours, &mut is_settled, &mut is_flipped);
        if looks_inwards(mesh, faces, &patch, &is_flipped) {
            for &idx in &patch {
                is_flipped[idx] = !is_flipped[idx];
            }
        }
    }
    for (is_flipped, face) in is_flipped.iter_mut().zip(faces) {
        *is_flipped &= face.twin.is_some();
    }
    is_flipped
}

/// Adds the faces that can be reached to a patch, turned as their neighbours.
fn spread(
    patch: &mut Vec<usize>,
    neighbours: &[Vec<(usize, bool)>],
    is_settled: &mut [bool],
    is_flipped: &mut [bool],
) {
    let mut next = 0;
    while let Some(&idx) = patch.get(next) {
        next += 1;
        for &(neighbour, agrees) in &neighbours[idx] {
            if !is_settled[neighbour] {
                is_settled[neighbour] = true;
                is_flipped[neighbour] = is_flipped[idx] == agrees;
                patch.push(neighbour);
            }
        }
    }
}

/// True if the volume between a patch and the mean of its corners is negative.
fn looks_inwards(
    mesh: &TriangleMesh,
    faces: &[Face],
    patch: &[usize],
    is_flipped: &[bool],
) -> bool {
    let corners = || {
        let at = |&idx: &usize| Some((idx, mesh.corners(faces[idx].triangle)?));
        patch.iter().filter_map(at)
    };
    let sum: Vector3<f32> = corners()
        .flat_map(|(_, corners)| corners)
        .map(|corner| corner.coords)
        .sum();
    let mean = sum / (3 * patch.len()) as f32;
    let volume: f32 = corners()
        .map(|(idx, corners)| {
            let [a, b, c] = corners.map(|corner| corner.coords - mean);
            let volume = a.dot(&b.cross(&c));
            if is_flipped[idx] { -volume } else { volume }
        })
        .sum();
    volume < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ellipsoid, rounded_box};

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
        let found = twice.drop_doubled_faces();
        assert_eq!(found.n_dropped, ball.triangles.len());
        assert_eq!(twice, ball);
    }

    #[test]
    fn doubled_faces_of_both_orientations_end_outwards() {
        let ball = ball();
        // Every third face is first met from inside.
        let mut both = doubled(&ball, |_, triangle| turned_over(triangle));
        let n = ball.triangles.len();
        for i in (0..n).step_by(3) {
            both.triangles.swap(i, n + i);
        }
        let found = both.drop_doubled_faces();
        assert_eq!((found.n_dropped, found.n_two_sided), (n, 0));
        assert!(both.diagnostics().is_sound());
        assert!((both.signed_volume() / ball.signed_volume() - 1.0).abs() < 1e-6);
        // Faces that are not doubled stay as they are.
        let mut half = doubled(&ball, |_, triangle| turned_over(triangle));
        half.triangles.truncate(n + n / 2);
        half.triangles[..n / 2].reverse();
        half.drop_doubled_faces();
        assert!(half.diagnostics().is_sound() && half.signed_volume() > 0.0);
    }

    #[test]
    fn doubled_faces_of_an_open_sheet_keep_both_sides() {
        let mut bowl = ball();
        bowl.triangles.truncate(bowl.triangles.len() / 2);
        let n = bowl.triangles.len();
        let mut both = doubled(&bowl, |_, triangle| turned_over(triangle));
        // The second copies are dropped in any case.
        both.triangles.extend_from_within(..);
        both.append(&rounded_box([0.2, 0.2, 0.2], 0.0, 1.0).mesh);
        let found = both.drop_doubled_faces();
        assert_eq!((found.n_dropped, found.n_two_sided), (2 * n, n));
        assert_eq!(both.triangles.len(), 2 * n + 12);
    }

    #[test]
    fn doubled_faces_of_a_volume_with_a_wall_inside_keep_both_sides() {
        // A wall at half the height of a box of two storeys: no patch encloses a volume alone.
        let mut storeys = rounded_box([0.1, 0.1, 0.1], 0.0, 1.0).mesh;
        let mut upper = storeys.clone();
        for vertex in &mut upper.vertices {
            vertex.position.z += 0.1;
        }
        storeys.append(&upper);
        let both = doubled(&storeys, |_, triangle| turned_over(triangle));
        let mut reduced = both.clone();
        let found = reduced.drop_doubled_faces();
        assert!(found.n_two_sided > 0, "{found:?}");
        let fronts = |mesh: &TriangleMesh| {
            let corners = (0..mesh.triangles.len()).filter_map(|i| mesh.corners(i));
            let up = corners.map(|[a, b, c]| ((b - a).cross(&(c - a)), a));
            let tops = up.filter(|(normal, a)| normal.z > 0.0 && a.z > 0.149);
            tops.map(|(normal, _)| normal.z / 2.0).sum::<f32>()
        };
        assert!(
            (fronts(&reduced) - 0.01).abs() < 1e-6,
            "the lid is still seen"
        );
    }

    #[test]
    fn doubled_faces_of_a_broken_mesh_are_dropped() {
        let mut mesh = ball();
        mesh.vertices[7].position.x = f32::NAN;
        mesh.triangles[3].vertices[1] = u32::MAX;
        mesh.triangles[5].vertices = [1, 1, 1];
        let mut twice = doubled(&mesh, |_, triangle| turned_over(triangle));
        twice.drop_doubled_faces();
        assert!(twice.triangles.len() >= mesh.triangles.len());
        assert_eq!(
            TriangleMesh::default().drop_doubled_faces(),
            DoubledFaces::default()
        );
    }
}
