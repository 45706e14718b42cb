//! Trials: one model from the views of an orbit, with noise on the camera poses.

use super::orbit::{Orbit, OrbitView};
use super::true_surface::TrueSurface;
use mesh::TriangleMesh;
use model_construction::{Config, ModelBuilder, PoseSigma, View};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use random::Random;
use registration::KdTree;
use statistics::percentiles::nearest_rank;
use std::time::Instant;

/// Distance within which a true surface is covered by the model, metres.
const COVERED_M: f32 = 0.005;

/// Number of samples of the surface for the errors of poses.
const N_POSE_SAMPLES: usize = 300;

/// Noise of the camera poses: standard deviations along and about each axis of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PoseNoise {
    pub(super) translation_mm: f64,
    pub(super) rotation_deg: f64,
}

impl PoseNoise {
    fn sigma(self) -> PoseSigma {
        PoseSigma {
            rotation_rad: self.rotation_deg.to_radians(),
            translation_m: 1e-3 * self.translation_mm,
        }
    }

    /// Pose with an error about the centre of the camera.
    fn disturbed(self, pose: &Isometry3<f64>, random: &mut Random) -> Isometry3<f64> {
        let sigma = self.sigma();
        let rotation = Vector3::from_fn(|_, _| sigma.rotation_rad * random.normal());
        let shift = Vector3::from_fn(|_, _| sigma.translation_m * random.normal());
        let error = Isometry3::from_parts(
            Translation3::from(shift),
            UnitQuaternion::from_scaled_axis(rotation),
        );
        pose * error
    }
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

/// Result of a trial.
#[derive(Debug)]
pub(super) struct Trial {
    /// Distances of the model from the true surface: mean and 95th percentile.
    pub(super) accuracy_mm: f64,
    pub(super) accuracy_p95_mm: f64,
    /// Share of the visible surface within 5 mm of the model, 0 to 1.
    pub(super) completeness: f64,
    pub(super) chamfer_mm: f64,
    pub(super) before: PoseError,
    /// Errors of the poses that were expected before each registration.
    pub(super) filtered: PoseError,
    pub(super) after: PoseError,
    pub(super) n_views: usize,
    /// Capture times of the fused views.
    pub(super) fused_ns: Vec<u64>,
    /// Sentences of the views that were refused.
    pub(super) refused: Vec<String>,
    pub(super) is_closed: bool,
    /// Time of each view, and of the last agreement of all views.
    pub(super) view_ms: Vec<f64>,
    pub(super) finish_ms: f64,
    pub(super) mesh: TriangleMesh,
}

/// Truth of an object.
#[derive(Debug, Clone, Copy)]
pub(super) enum Truth<'a> {
    /// Surface, and which of its samples are visible.
    Surface(&'a TrueSurface, &'a [bool]),
    /// Places on the surface only, in the frame of the object.
    Samples(&'a [Point3<f64>]),
}

/// Builds a model of noisy views and compares it with the truth.
pub(super) fn run(orbit: &Orbit, truth: Truth<'_>, noise: PoseNoise, seed: u64) -> Trial {
    let mut random = Random::from_seed(seed);
    let mut builder = ModelBuilder::new(Config::default());
    let (mut refused, mut view_ms) = (Vec::new(), Vec::new());
    for view in &orbit.views {
        let world_from_camera = noise.disturbed(&view.world_from_camera, &mut random);
        let begun = Instant::now();
        let added = builder.add(&View {
            points: &view.points,
            camera: orbit.camera,
            captured_ns: view.captured_ns,
            world_from_camera: Some(world_from_camera),
            sigma: noise.sigma(),
        });
        view_ms.push(1e3 * begun.elapsed().as_secs_f64());
        refused.extend(added.err().map(|error| error.to_string()));
    }
    // A model with a bad beginning has begun anew.
    let is_kept = |view: &&OrbitView| {
        builder
            .views()
            .iter()
            .any(|built| built.captured_ns == view.captured_ns)
    };
    let kept: Vec<&OrbitView> = orbit.views.iter().filter(is_kept).collect();
    let begun = Instant::now();
    builder.finish();
    let finish_ms = 1e3 * begun.elapsed().as_secs_f64();
    let scored = Scored::new(orbit, truth, &builder, &kept);
    let mesh = builder.mesh();
    let (accuracy, completeness, coverage_mm) = scored.surface(&mesh);
    let mean = accuracy.iter().sum::<f64>() / accuracy.len() as f64;
    Trial {
        accuracy_mm: mean,
        accuracy_p95_mm: nearest_rank(&accuracy, 0.95).unwrap_or(f64::NAN),
        completeness,
        chamfer_mm: 0.5 * (mean + coverage_mm),
        before: scored.pose_error(|view| view.reported),
        filtered: scored.pose_error(|view| view.expected),
        after: scored.pose_error(|view| view.object_from_camera),
        n_views: kept.len(),
        fused_ns: kept.iter().map(|view| view.captured_ns).collect(),
        refused,
        is_closed: builder.is_closed(),
        view_ms,
        finish_ms,
        mesh: scored.in_true_frame(mesh),
    }
}

/// Model beside the truth.
struct Scored<'a> {
    truth: Truth<'a>,
    builder: &'a ModelBuilder,
    /// True poses of the cameras, in the frame of the true object.
    cameras: Vec<Isometry3<f64>>,
    samples: Vec<Point3<f64>>,
    /// Pose of the model's frame in that of the true object.
    truth_from_model: Isometry3<f64>,
}

impl<'a> Scored<'a> {
    fn new(
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
    fn surface(&self, mesh: &TriangleMesh) -> (Vec<f64>, f64, f64) {
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
    fn pose_error(
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

    fn in_true_frame(&self, mut mesh: TriangleMesh) -> TriangleMesh {
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
    let rotation = Rotation3::from_matrix(&sum);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
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

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    nearest_rank(&values, 0.5).unwrap_or(f64::NAN)
}
