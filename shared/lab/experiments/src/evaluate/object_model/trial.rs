//! Trials: one model from the views of an orbit, with noise on the camera poses.

use super::orbit::{Orbit, OrbitView};
use super::scored_model::{PoseError, ScoredModel, Truth};
use mesh::TriangleMesh;
use model_construction::{Config, ModelBuilder, PoseSigma, View};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use random::Random;
use statistics::percentiles::nearest_rank;
use std::time::Instant;

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

/// Fused view with its registered pose in the frame of the model.
#[derive(Debug, Clone, Copy)]
pub(super) struct FusedView {
    pub(super) captured_ns: u64,
    pub(super) object_from_camera: Isometry3<f64>,
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
    /// Reported poses of all cameras in the world.
    pub(super) reported: Vec<Isometry3<f64>>,
    pub(super) fused: Vec<FusedView>,
    /// Sentences of the views that were refused.
    pub(super) refused: Vec<String>,
    pub(super) is_closed: bool,
    /// Time of each view, and of the last agreement of all views.
    pub(super) view_ms: Vec<f64>,
    pub(super) finish_ms: f64,
    pub(super) mesh: TriangleMesh,
}

/// Builds a model of noisy views and compares it with the truth.
pub(super) fn run(orbit: &Orbit, truth: Truth<'_>, noise: PoseNoise, seed: u64) -> Trial {
    let mut random = Random::from_seed(seed);
    let mut builder = ModelBuilder::new(Config {
        turn_rad: orbit.turn_rad,
        ..Config::default()
    });
    let (mut reported, mut refused, mut view_ms) = (Vec::new(), Vec::new(), Vec::new());
    for view in &orbit.views {
        let (known, placement) = orbit.known_pose(view);
        let world_from_camera = noise.disturbed(&known, &mut random);
        reported.push(world_from_camera);
        let begun = Instant::now();
        let added = builder.add(&View {
            points: &view.points,
            camera: orbit.camera,
            captured_ns: view.captured_ns,
            world_from_camera: Some(world_from_camera),
            sigma: noise.sigma(),
            up_in_camera: None,
            placement,
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
    let scored = ScoredModel::new(orbit, truth, &builder, &kept);
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
        reported,
        fused: builder.views().iter().map(fused_view).collect(),
        refused,
        is_closed: builder.is_closed(),
        view_ms,
        finish_ms,
        mesh: scored.in_true_frame(mesh),
    }
}

fn fused_view(view: &model_construction::BuiltView) -> FusedView {
    FusedView {
        captured_ns: view.captured_ns,
        object_from_camera: view.object_from_camera,
    }
}
