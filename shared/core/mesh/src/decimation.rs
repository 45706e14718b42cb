//! Mesh decimation by vertex clustering.

use crate::{Triangle, TriangleMesh, Vertex};
use nalgebra::{Matrix3, Point3, Vector3};
use std::collections::{HashMap, HashSet};

/// Number of bisection steps for the cell size.
const N_SEARCH_STEPS: usize = 12;
/// Crease angle of a decimated mesh, radians: sharper edges stay sharp. Chosen.
const CREASE_RAD: f32 = 0.9;
/// Relative singular value below which a direction is left unconstrained by the planes of a
/// cell. Chosen.
const FLATNESS: f32 = 0.02;

impl TriangleMesh {
    /// Decimates to at most `n_triangles_max` triangles; returns a copy of a mesh that is small
    /// enough. Works on any mesh, including damaged ones; holes may close and thin walls may
    /// collapse.
    ///
    /// Vertices are clustered in a grid (Rossignac and Borrel 1993), as fine as
    /// the limit allows; a cell is represented by the point nearest to the
    /// planes of its faces (Lindstrom 2000). Normals are recomputed.
    pub fn decimate(&self, n_triangles_max: usize) -> Self {
        if self.triangles.len() <= n_triangles_max {
            return self.clone();
        }
        let Some(bounds) = self.bounds() else {
            return Self::default();
        };
        // A uniform mesh has about two triangles in each cell that it crosses.
        let longest = bounds.sides().max().max(f32::MIN_POSITIVE);
        let guess = (2.0 * self.surface_area() / n_triangles_max.max(1) as f64).sqrt() as f32;
        let (mut low, mut high) = (guess / 8.0, longest * 2.0);
        for _ in 0..N_SEARCH_STEPS {
            let middle = (low * high).sqrt();
            if self.cells(&bounds.min, middle).1.len() <= n_triangles_max {
                high = middle;
            } else {
                low = middle;
            }
        }
        self.clustered(&bounds.min, high)
    }

    /// Cell of each vertex, and the triangles that span three cells.
    fn cells(&self, origin: &Point3<f32>, edge_m: f32) -> (Vec<u32>, Vec<(usize, [u32; 3])>) {
        let mut known = HashMap::new();
        let cell_of_vertex: Vec<u32> = self
            .vertices
            .iter()
            .map(|vertex| {
                let offset = (vertex.position - origin) / edge_m;
                let key = [offset.x, offset.y, offset.z].map(|x| x.floor() as i32);
                let next = known.len() as u32;
                *known.entry(key).or_insert(next)
            })
            .collect();
        let mut seen = HashSet::new();
        let spanning = (0..self.triangles.len())
            .filter_map(|i| {
                let corners = self.corners(i)?;
                let cells = self.triangles[i]
                    .vertices
                    .map(|v| cell_of_vertex[v as usize]);
                let finite = corners.iter().all(|p| p.iter().all(|x| x.is_finite()));
                let spans = !crate::welding::is_degenerate(cells) && finite;
                (spans && seen.insert(canonical_order(cells))).then_some((i, cells))
            })
            .collect();
        (cell_of_vertex, spanning)
    }

    fn clustered(&self, origin: &Point3<f32>, edge_m: f32) -> Self {
        let (cell_of_vertex, spanning) = self.cells(origin, edge_m);
        let n_cells = cell_of_vertex
            .iter()
            .max()
            .map_or(0, |last| *last as usize + 1);
        let mut clusters = vec![Cluster::default(); n_cells];
        for (vertex, cell) in self.vertices.iter().zip(&cell_of_vertex) {
            clusters[*cell as usize].add_vertex(vertex);
        }
        for i in 0..self.triangles.len() {
            if let Some(corners) = self.corners(i) {
                for vertex in self.triangles[i].vertices {
                    clusters[cell_of_vertex[vertex as usize] as usize].add_face(corners);
                }
            }
        }
        let mut mesh = Self {
            vertices: clusters.iter().map(|c| c.vertex(edge_m)).collect(),
            triangles: spanning
                .into_iter()
                .map(|(i, vertices)| Triangle {
                    vertices,
                    surface: self.triangles[i].surface,
                })
                .collect(),
            surfaces: self.surfaces.clone(),
        };
        mesh.smooth_normals(CREASE_RAD);
        mesh
    }
}

/// Rotation of a face's corners to a canonical start, orientation kept.
pub(crate) fn canonical_order([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Quadric of one cell: sums over its vertices and over the planes of their faces.
#[derive(Clone, Default)]
struct Cluster {
    n: f32,
    position_sum: Vector3<f32>,
    color_sum: Vector3<f32>,
    /// Sum of n nᵀ, weighted by area.
    quadric: Matrix3<f32>,
    /// Sum of n (n · p), weighted by area.
    moment: Vector3<f32>,
}

impl Cluster {
    fn add_vertex(&mut self, vertex: &Vertex) {
        if vertex.position.iter().all(|x| x.is_finite()) {
            self.n += 1.0;
            self.position_sum += vertex.position.coords;
            self.color_sum += Vector3::from(vertex.color.map(f32::from));
        }
    }

    fn add_face(&mut self, [a, b, c]: [Point3<f32>; 3]) {
        let cross = (b - a).cross(&(c - a));
        if let Some(normal) = cross.try_normalize(0.0).filter(|n| n.x.is_finite()) {
            let weighted = normal * cross.norm();
            self.quadric += weighted * normal.transpose();
            self.moment += weighted * normal.dot(&a.coords);
        }
    }

    /// Representative vertex: nearest to the planes, at most one cell away from the mean.
    fn vertex(&self, edge_m: f32) -> Vertex {
        let mean = self.position_sum / self.n.max(1.0);
        let svd = self.quadric.svd(true, true);
        let least = FLATNESS * svd.singular_values.max();
        let to_planes = svd
            .solve(
                &(self.moment - self.quadric * mean),
                least.max(f32::MIN_POSITIVE),
            )
            .ok()
            .filter(|shift| shift.norm() < edge_m)
            .unwrap_or_else(Vector3::zeros);
        let color = self.color_sum / self.n.max(1.0);
        Vertex {
            position: Point3::from(mean + to_planes),
            normal: Vector3::z(),
            color: [color.x, color.y, color.z].map(|c| c.round() as u8),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{ellipsoid, rounded_box};

    #[test]
    fn a_ball_stays_a_ball() {
        let ball = ellipsoid([0.05, 0.05, 0.05], 128).mesh;
        let coarse = ball.decimate(1500);
        assert!(
            (700..=1500).contains(&coarse.triangles.len()),
            "{}",
            coarse.triangles.len()
        );
        assert!((coarse.signed_volume() / ball.signed_volume() - 1.0).abs() < 0.03);
        for vertex in &coarse.vertices {
            assert!((vertex.position.coords.norm() - 0.05).abs() < 0.002);
        }
    }

    #[test]
    fn a_box_keeps_its_corners() {
        let fine = rounded_box([0.1, 0.2, 0.3], 0.0, 0.004).mesh;
        let coarse = fine.decimate(600);
        assert!(coarse.triangles.len() <= 600);
        assert!((coarse.signed_volume() / 0.006 - 1.0).abs() < 0.02);
        let (a, b) = (fine.bounds().unwrap(), coarse.bounds().unwrap());
        assert!((a.sides() - b.sides()).norm() < 0.003);
    }

    #[test]
    fn broken_meshes_are_decimated() {
        let mut mesh = ellipsoid([0.05, 0.02, 0.05], 64).mesh;
        mesh.vertices[7].position.x = f32::NAN;
        mesh.vertices[9].position.y = f32::INFINITY;
        mesh.triangles[3].vertices[1] = u32::MAX;
        mesh.triangles.truncate(2000);
        let coarse = mesh.decimate(300);
        assert!(!coarse.triangles.is_empty() && coarse.triangles.len() <= 300);
        assert_eq!(coarse.diagnostics().n_invalid_triangles, 0);
    }
}
