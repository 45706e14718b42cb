//! Report of object models.

use super::orbit::Path;
use super::recognition_gain::RecognitionGain;
use super::scored_model::{PoseError, median};
use super::trial::{PoseNoise, Trial};
use serde::Serialize;

/// Report of object models.
#[derive(Debug, Serialize)]
pub(super) struct ModelReport {
    pub(super) seed: u64,
    pub(super) n_objects: usize,
    /// Views along each path; `None` for a recorded sequence.
    pub(super) n_views: Option<u32>,
    /// Recognition of never taught sides; `None` for a recorded sequence or a single object.
    pub(super) recognition: Option<RecognitionGain>,
    pub(super) levels: Vec<LevelReport>,
}

/// Figures of one path and one noise of the camera poses: medians over the objects.
#[derive(Debug, Serialize)]
pub(super) struct LevelReport {
    pub(super) path: Path,
    pub(super) sigma_translation_mm: f64,
    pub(super) sigma_rotation_deg: f64,
    /// Mean distance of the model from the true surface.
    pub(super) accuracy_mm: f64,
    pub(super) accuracy_p95_mm: f64,
    /// Share of the visible surface within 5 mm of the model.
    pub(super) completeness: f64,
    pub(super) chamfer_mm: f64,
    /// Displacement of the object's surface by the errors of the camera poses, millimetres: of
    /// the reported ones, of the filtered ones, and of the registered ones.
    pub(super) pose_error_before: f64,
    pub(super) pose_error_filtered: f64,
    pub(super) pose_error_after: f64,
    pub(super) rotation_error_before_deg: f64,
    pub(super) rotation_error_after_deg: f64,
    pub(super) translation_error_before_mm: f64,
    pub(super) translation_error_after_mm: f64,
    /// Share of the views that were refused.
    pub(super) refused_share: f64,
    /// Share of the orbits whose loop was closed.
    pub(super) closed_share: f64,
    pub(super) view_ms: f64,
    pub(super) view_p95_ms: f64,
    pub(super) finish_ms: f64,
    pub(super) objects: Vec<ObjectFigures>,
}

/// Figures of one object.
#[derive(Debug, Serialize)]
pub(super) struct ObjectFigures {
    pub(super) name: String,
    pub(super) accuracy_mm: f64,
    pub(super) completeness: f64,
    pub(super) chamfer_mm: f64,
    pub(super) pose_error_before: f64,
    pub(super) pose_error_after: f64,
    pub(super) n_views: usize,
    /// Reasons of the refused views.
    pub(super) refused: Vec<String>,
    pub(super) is_closed: bool,
}

impl ObjectFigures {
    pub(super) fn of(name: &str, trial: &Trial) -> Self {
        Self {
            name: name.to_owned(),
            accuracy_mm: trial.accuracy_mm,
            completeness: trial.completeness,
            chamfer_mm: trial.chamfer_mm,
            pose_error_before: trial.before.surface_mm,
            pose_error_after: trial.after.surface_mm,
            n_views: trial.fused.len(),
            refused: trial.refused.clone(),
            is_closed: trial.is_closed,
        }
    }
}

impl LevelReport {
    /// Medians over the trials of a level.
    pub(super) fn of(path: Path, noise: PoseNoise, trials: &[(String, Trial)]) -> Self {
        let value = |value: fn(&Trial) -> f64| {
            median(trials.iter().map(|(_, trial)| value(trial)).collect())
        };
        let pose = |value: fn(&PoseError) -> f64| {
            let of = |pick: fn(&Trial) -> PoseError| {
                median(
                    trials
                        .iter()
                        .map(|(_, trial)| value(&pick(trial)))
                        .collect(),
                )
            };
            [
                of(|trial| trial.before),
                of(|trial| trial.filtered),
                of(|trial| trial.after),
            ]
        };
        let surface = pose(|error| error.surface_mm);
        let (rotation, translation) = (
            pose(|error| error.rotation_deg),
            pose(|error| error.translation_mm),
        );
        let n_views: usize = trials.iter().map(|(_, trial)| trial.fused.len()).sum();
        let n_refused: usize = trials.iter().map(|(_, trial)| trial.refused.len()).sum();
        let n_closed = trials.iter().filter(|(_, trial)| trial.is_closed).count();
        let mut times: Vec<f64> = trials
            .iter()
            .flat_map(|(_, trial)| trial.view_ms.iter().copied())
            .collect();
        times.sort_unstable_by(f64::total_cmp);
        let time = |share| statistics::percentiles::nearest_rank(&times, share).unwrap_or(f64::NAN);
        Self {
            path,
            sigma_translation_mm: noise.translation_mm,
            sigma_rotation_deg: noise.rotation_deg,
            accuracy_mm: value(|trial| trial.accuracy_mm),
            accuracy_p95_mm: value(|trial| trial.accuracy_p95_mm),
            completeness: value(|trial| trial.completeness),
            chamfer_mm: value(|trial| trial.chamfer_mm),
            pose_error_before: surface[0],
            pose_error_filtered: surface[1],
            pose_error_after: surface[2],
            rotation_error_before_deg: rotation[0],
            rotation_error_after_deg: rotation[2],
            translation_error_before_mm: translation[0],
            translation_error_after_mm: translation[2],
            refused_share: n_refused as f64 / (n_views + n_refused).max(1) as f64,
            closed_share: n_closed as f64 / trials.len().max(1) as f64,
            view_ms: time(0.5),
            view_p95_ms: time(0.95),
            finish_ms: value(|trial| trial.finish_ms),
            objects: trials
                .iter()
                .map(|(name, trial)| ObjectFigures::of(name, trial))
                .collect(),
        }
    }
}
