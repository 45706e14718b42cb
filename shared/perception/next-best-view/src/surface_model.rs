//! Surface model: evenly spread points on the surface of an object.

use crate::error::Error;
use mesh::{TriangleMesh, Vertex};
use nalgebra::Point3;
use value_range::check_range;

/// Greatest coordinate of a model, metres.
const COORDINATE_MAX_M: f32 = 10.0;

/// Spacings of a model, metres.
const SPACING_M: [f64; 2] = [0.0002, 0.5];

/// Subdivisions of one side of a triangle at most, 3 m at the default cells; a larger one is
/// sampled more sparsely. Chosen: two million points.
const N_SUBDIVISIONS_MAX: f32 = 2000.0;

/// Points on the surface of an object, frame of the object, metres: at most one in each voxel.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceModel {
    points: Vec<[f32; 3]>,
    spacing_m: f32,
}

impl SurfaceModel {
    /// Model of measured points, thinned to the one nearest the middle of each voxel with sides of
    /// `spacing_m`, metres. Points that are sparser than that stay so.
    ///
    /// # Errors
    /// No points, a coordinate that is not finite or beyond 10 m, or a spacing outside of 0.2 mm
    /// to 0.5 m.
    pub fn of_points(points: &[[f32; 3]], spacing_m: f64) -> Result<Self, Error> {
        check_range("spacing_m", spacing_m, SPACING_M[0], SPACING_M[1])?;
        if let Some(index) = points.iter().position(|point| !is_usable(point)) {
            return Err(Error::ModelPoint(index));
        }
        if points.is_empty() {
            return Err(Error::EmptyModel);
        }
        Ok(Self {
            points: thinned(points, spacing_m as f32),
            spacing_m: spacing_m as f32,
        })
    }

    /// Model of the faces of a mesh, sampled twice as densely as the spacing and thinned. Faces
    /// with a missing corner are left out.
    ///
    /// # Errors
    /// As for [`of_points`](Self::of_points).
    pub fn of_mesh(mesh: &TriangleMesh, spacing_m: f64) -> Result<Self, Error> {
        check_range("spacing_m", spacing_m, SPACING_M[0], SPACING_M[1])?;
        let is_bad = |vertex: &Vertex| !is_usable(&vertex.position.into());
        if let Some(index) = mesh.vertices.iter().position(is_bad) {
            return Err(Error::ModelPoint(index));
        }
        let mut points = Vec::new();
        for triangle in &mesh.triangles {
            let corner = |i: usize| mesh.vertices.get(triangle.vertices[i] as usize);
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                let corners = [a.position, b.position, c.position];
                add_samples(&corners, spacing_m as f32 / 2.0, &mut points);
            }
        }
        Self::of_points(&points, spacing_m)
    }

    /// Points of the model, frame of the object, metres.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// Side of the voxels of which each holds one point, metres.
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m.into()
    }
}

/// `true` for a point with finite coordinates of at most 10 m.
fn is_usable(point: &[f32; 3]) -> bool {
    point.iter().all(|c| c.abs() <= COORDINATE_MAX_M)
}

/// Adds the points of a triangular lattice on a face, corners included.
fn add_samples(corners: &[Point3<f32>; 3], spacing_m: f32, points: &mut Vec<[f32; 3]>) {
    let [a, b, c] = corners;
    let (ab, ac) = (b - a, c - a);
    let longest_m = ab.norm().max(ac.norm()).max((c - b).norm());
    let n = (longest_m / spacing_m)
        .ceil()
        .clamp(1.0, N_SUBDIVISIONS_MAX) as usize;
    for i in 0..=n {
        for j in 0..=n - i {
            let (s, t) = (i as f32 / n as f32, j as f32 / n as f32);
            points.push((a + ab * s + ac * t).into());
        }
    }
}

/// Point nearest the middle of each voxel, in the order of the voxels.
pub(crate) fn thinned(points: &[[f32; 3]], spacing_m: f32) -> Vec<[f32; 3]> {
    let mut keyed: Vec<([i32; 3], f32, [f32; 3])> = points
        .iter()
        .map(|point| {
            let voxel = point.map(|c| (c / spacing_m).floor());
            let off = |axis: usize| point[axis] / spacing_m - voxel[axis] - 0.5;
            let distance = (0..3).map(|axis| off(axis).powi(2)).sum();
            (voxel.map(|c| c as i32), distance, *point)
        })
        .collect();
    keyed.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    keyed.dedup_by_key(|entry| entry.0);
    keyed.into_iter().map(|(_, _, point)| point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mesh_is_covered_without_gaps_and_without_crowds() {
        let cube = mesh::rounded_box([0.06; 3], 0.002, 0.05).mesh;
        let model = SurfaceModel::of_mesh(&cube, 0.003).unwrap();
        // A voxel grid meets a plane in about one voxel for each cell, slanted ones in more.
        let n_cells = 6.0 * (0.06_f32 / 0.003).powi(2);
        let n = model.points().len() as f32;
        assert!((0.9..1.6).contains(&(n / n_cells)), "{n} for {n_cells}");
        // Every place of the top face has a point nearby.
        for i in 0..100_u8 {
            let place = [f32::from(i % 10), f32::from(i / 10)].map(|k| -0.026 + k * 0.0057);
            let nearest = model
                .points()
                .iter()
                .map(|p| (p[0] - place[0]).hypot(p[1] - place[1]) + (p[2] - 0.03).abs());
            assert!(nearest.fold(f32::INFINITY, f32::min) < 0.004);
        }
    }

    #[test]
    fn thinning_keeps_one_point_for_each_voxel() {
        let crowd: Vec<[f32; 3]> = (0..1000_u16).map(|i| [f32::from(i) * 1e-4; 3]).collect();
        let model = SurfaceModel::of_points(&crowd, 0.01).unwrap();
        assert_eq!(model.points().len(), 10);
    }

    #[test]
    fn unusable_points_are_refused_with_their_place() {
        let bad = [[0.0; 3], [0.0, f32::NAN, 0.0]];
        let refused = |points: &[[f32; 3]], spacing_m| {
            SurfaceModel::of_points(points, spacing_m).unwrap_err()
        };
        assert_eq!(refused(&bad, 0.003), Error::ModelPoint(1));
        assert_eq!(refused(&[[11.0, 0.0, 0.0]], 0.003), Error::ModelPoint(0));
        assert_eq!(refused(&[], 0.003), Error::EmptyModel);
        let mut huge = mesh::rounded_box([0.1; 3], 0.002, 0.1).mesh;
        huge.vertices[3].position.x = 1e9;
        assert_eq!(
            SurfaceModel::of_mesh(&huge, 0.003),
            Err(Error::ModelPoint(3))
        );
        assert_eq!(
            SurfaceModel::of_mesh(&TriangleMesh::default(), 0.003),
            Err(Error::EmptyModel)
        );
        assert!(matches!(refused(&[[0.0; 3]], 0.0), Error::Setting { .. }));
        assert!(matches!(
            refused(&[[0.0; 3]], f64::NAN),
            Error::Setting { .. }
        ));
    }
}
