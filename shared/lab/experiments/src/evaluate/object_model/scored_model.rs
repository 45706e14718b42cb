//! Score of a model: its distance from the true surface, and the errors of its poses.

use super::orbit::{Orbit, OrbitView};
use super::true_surface::TrueSurface;
use mesh::TriangleMesh;
use model_construction::ModelBuilder;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use registration::KdTree;
use statistics::percentiles::nearest_rank;

/// Distance within which a true surface is covered by the model, metres.
const COVERED_M: f32 = 0.005;

/// Number of samples of the surface for the errors of poses.
const N_POSE_SAMPLES: usize = 300;

/// Truth of an object.
#[derive(Debug, Clone, Copy)]
pub(super) enum Truth<'a> {
    /// Surface, and which of its samples are visible.
    Surface(&'a TrueSurface, &'a [bool]),
    /// Places on the surface only, in the frame of the object.
    Samples(&'a [Point3<f64>]),
}

/// Errors of camera poses after the best common alignment with the true ones.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PoseError {
    /// Displacement of the object's surface, root mean square of a view, median of the views.
    pub(super) surface_mm: f64,
    /// Displacement of the object's centre, median of the views.
    pub(super) translation_mm: f64,
    /// Rotation, median of the views.
    pub(super) rotation_deg: f64,
}

/// Model beside the truth.
pub(super) struct ScoredModel<'a> {
    truth: Truth<'a>,
    builder: &'a ModelBuilder,
    /// True poses of the cameras, in the frame of the true object.
    cameras: Vec<Isometry3<f64>>,
    samples: Vec<Point3<f64>>,
    /// Pose of the model's frame in that of the true object.
    truth_from_model: Isometry3<f64>,
}

impl<'a> ScoredModel<'a> {
    pub(super) fn new(
        orbit: &Orbit,
        truth: Truth<'a>,
        builder: &'a ModelBuilder,
        kept: &[&OrbitView],
    ) -> Self {
        let object_from_world = orbit.world_from_object.inverse();
        let cameras: Vec<Isometry3<f64>> = kept
            .iter()
            .map(|view| object_from_world * view.world_from_camera)
            .collect();
        let all: Vec<Point3<f64>> = match truth {
            Truth::Surface(surface, _) => surface.samples().collect(),
            Truth::Samples(samples) => samples.to_vec(),
        };
        let step = (all.len() / N_POSE_SAMPLES).max(1);
        let samples = all.into_iter().step_by(step).collect();
        let built: Vec<Isometry3<f64>> = builder
            .views()
            .iter()
            .map(|view| view.object_from_camera)
            .collect();
        Self {
            truth_from_model: common_alignment(&cameras, &built),
            truth,
            builder,
            cameras,
            samples,
        }
    }

    /// Sorted distances of the mesh from the true surface, millimetres, the share of the visible
    /// surface that it covers, and the mean distance of that surface from it, millimetres. No
    /// numbers where the surface is not known.
    pub(super) fn surface(&self, mesh: &TriangleMesh) -> (Vec<f64>, f64, f64) {
        let Truth::Surface(truth, visible) = self.truth else {
            return (Vec::new(), f64::NAN, f64::NAN);
        };
        let moved = |vertex: &mesh::Vertex| self.truth_from_model * vertex.position.cast::<f64>();
        let vertices: Vec<Point3<f64>> = mesh.vertices.iter().map(moved).collect();
        let distance_mm = |place| 1e3 * truth.distance_m(place);
        let mut accuracy: Vec<f64> = vertices.iter().map(distance_mm).collect();
        accuracy.sort_unstable_by(f64::total_cmp);
        let places = vertices
            .iter()
            .map(|place| place.cast::<f32>().coords.into());
        let tree = KdTree::new(&places.collect::<Vec<[f32; 3]>>());
        let (mut n_visible, mut n_covered, mut sum_mm) = (0_usize, 0_usize, 0.0);
        for (place, _) in truth.places.iter().zip(visible).filter(|(_, seen)| **seen) {
            let nearest = tree.nearest(*place, f32::INFINITY);
            let squared = nearest.map_or(1.0, |(_, squared)| squared);
            n_visible += 1;
            n_covered += usize::from(squared < COVERED_M * COVERED_M);
            sum_mm += 1e3 * f64::from(squared).sqrt();
        }
        let n_visible = n_visible.max(1) as f64;
        (accuracy, n_covered as f64 / n_visible, sum_mm / n_visible)
    }

    /// Error of poses of the views after their own best alignment with the true ones.
    pub(super) fn pose_error(
        &self,
        pose: impl Fn(&model_construction::BuiltView) -> Isometry3<f64>,
    ) -> PoseError {
        let poses: Vec<Isometry3<f64>> = self.builder.views().iter().map(pose).collect();
        let aligned = common_alignment(&self.cameras, &poses);
        let (mut surface, mut translation, mut rotation) = (Vec::new(), Vec::new(), Vec::new());
        for (truth, pose) in self.cameras.iter().zip(&poses) {
            let off = aligned * pose * truth.inverse();
            let squared = |sample: &Point3<f64>| (off * sample - sample).norm_squared();
            let sum: f64 = self.samples.iter().map(squared).sum();
            surface.push(1e3 * (sum / self.samples.len().max(1) as f64).sqrt());
            translation.push(1e3 * off.translation.vector.norm());
            rotation.push(off.rotation.angle().to_degrees());
        }
        PoseError {
            surface_mm: median(surface),
            translation_mm: median(translation),
            rotation_deg: median(rotation),
        }
    }

    pub(super) fn in_true_frame(&self, mut mesh: TriangleMesh) -> TriangleMesh {
        mesh.transform(&self.truth_from_model.cast());
        mesh
    }
}

/// Pose `truth_from_model` that brings camera poses nearest to the true ones, for the rotation
/// (chordal mean) and then for the origin of the truth.
fn common_alignment(truth: &[Isometry3<f64>], poses: &[Isometry3<f64>]) -> Isometry3<f64> {
    let matrix = |pose: &Isometry3<f64>| pose.rotation.to_rotation_matrix().into_inner();
    let sum: Matrix3<f64> = truth
        .iter()
        .zip(poses)
        .map(|(truth, pose)| matrix(truth) * matrix(pose).transpose())
        .sum();
    let rotation = nearest_rotation(&sum);
    let shift = |(truth, pose): (&Isometry3<f64>, &Isometry3<f64>)| {
        // Place of the true origin in the frame of the model.
        let origin = pose * truth.inverse() * Point3::origin();
        -(rotation * origin.coords)
    };
    let mut shifts: [Vec<f64>; 3] = Default::default();
    for pair in truth.iter().zip(poses) {
        for (values, value) in shifts.iter_mut().zip(&shift(pair)) {
            values.push(*value);
        }
    }
    let mean = shifts.map(|values| values.iter().sum::<f64>() / values.len().max(1) as f64);
    Isometry3::from_parts(Translation3::from(Vector3::from(mean)), rotation)
}

/// Rotation nearest to a matrix, by its singular values (Kabsch 1976); the identity where there is
/// none. The iteration of `Rotation3::from_matrix` does not end where rotations cancel each other.
fn nearest_rotation(matrix: &Matrix3<f64>) -> UnitQuaternion<f64> {
    if matrix.iter().any(|value| !value.is_finite()) {
        return UnitQuaternion::identity();
    }
    let svd = matrix.svd(true, true);
    let (Some(left), Some(right)) = (svd.u, svd.v_t) else {
        return UnitQuaternion::identity();
    };
    let sign = (left * right).determinant().signum();
    let proper = left * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * right;
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(proper))
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    nearest_rank(&values, 0.5).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_rotation_is_the_chordal_mean_of_rotations() {
        let turn = |angle: f64| UnitQuaternion::from_scaled_axis(Vector3::new(0.2, angle, -0.1));
        let matrix = |angle: f64| turn(angle).to_rotation_matrix().into_inner();
        let mean = nearest_rotation(&(matrix(0.4) + matrix(0.4)));
        assert!(mean.angle_to(&turn(0.4)) < 1e-9);
        let about = |axis: Vector3<f64>| UnitQuaternion::from_scaled_axis(axis);
        let sum = [0.3, 0.5].map(|angle| about(Vector3::z() * angle));
        let sum =
            sum[0].to_rotation_matrix().into_inner() + sum[1].to_rotation_matrix().into_inner();
        assert!(nearest_rotation(&sum).angle_to(&about(Vector3::z() * 0.4)) < 1e-9);
    }

    #[test]
    fn nearest_rotation_ends_where_rotations_cancel_each_other() {
        let flip = |axis: Vector3<f64>| {
            let turn = UnitQuaternion::from_scaled_axis(axis * std::f64::consts::PI);
            turn.to_rotation_matrix().into_inner()
        };
        let half_turns = flip(Vector3::x()) + flip(Vector3::y()) + flip(Vector3::z());
        let reflection = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
        let sums = [
            Matrix3::zeros(),
            half_turns,
            half_turns + Matrix3::identity(),
            reflection,
            Matrix3::repeat(f64::NAN),
        ];
        for sum in sums {
            let norm = nearest_rotation(&sum).norm();
            assert!((norm - 1.0).abs() < 1e-9, "{sum}: {norm}");
        }
    }
}
