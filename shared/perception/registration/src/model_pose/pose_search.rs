//! Search of the pose of a model: starts from view templates, alignment in two stages.

use super::pose_score::{ScoreDetail, contradiction, model_contradiction, segment_contradiction};
use super::view_template::{ViewTemplate, centroid_and_spread};
use super::{ModelPose, PoseModel, SegmentView};
use crate::Error;
use crate::generalized_icp::{Aligner, Schedule};
use crate::prior::Prior;
use crate::register::thinned;
use nalgebra::{Isometry3, Point3};

/// Numbers of elements of the segment in the score of the starts, in the first alignments, and in
/// the last ones. Chosen.
const N_START_ELEMENTS: usize = 28;
const N_COARSE_ELEMENTS: usize = 80;
const N_FINE_ELEMENTS: usize = 200;

/// Strides over the points of a template in the scores of the starts and of the first alignments.
/// Chosen.
const START_STRIDE: usize = 6;
const COARSE_STRIDE: usize = 2;

/// Number of starts that are aligned, and of those that are aligned with all elements. Chosen.
const N_ALIGNED: usize = 120;
const N_REFINED: usize = 4;

/// Tolerance of the score of a start: a share of the model's diameter within bounds in metres, for
/// a start is off by the distance of neighbouring directions. Chosen.
const START_TOLERANCE: f64 = 0.10;
pub(super) const START_TOLERANCE_M: std::ops::RangeInclusive<f64> = 0.008..=0.035;
/// Tolerances of the scores after the first and the last alignments, metres. Chosen.
const COARSE_TOLERANCE_M: f64 = 0.008;
const FINE_TOLERANCE_M: f64 = 0.005;

/// Tolerance in standard deviations of the noise of the segment, where this is more.
const TOLERANCE_SIGMAS: f64 = 2.5;

/// Reach of the first alignments as a share of the model's diameter. Chosen.
const REACH_SHARE: f64 = 0.2;

/// Uncertainty of a start: a share of the model's diameter, and an angle, radians. Chosen: it only
/// keeps what the surfaces do not tell, such as the turn of a can.
const PRIOR_SHARE: f64 = 0.2;
const PRIOR_RAD: f64 = 0.35;

/// Last alignments, with all elements.
const FINE_SCHEDULE: Schedule = Schedule {
    n_steps: 15,
    reach_m: [0.012, 0.006],
    factor: 0.85,
    rotation_min_rad: 5e-4,
};

/// Candidate pose with its contradiction.
type Scored = (f64, Isometry3<f64>);

/// Model and the segment in which its pose is searched.
type Pair<'a> = (&'a PoseModel, &'a SegmentView);

/// Stage of the alignment of candidate poses: detail of their scores, schedule, and whether the
/// model's elements are looked up in its grid in place of the exact search.
struct Stage<'a> {
    detail: ScoreDetail<'a>,
    schedule: Schedule,
    uses_grid: bool,
}

/// Estimates the pose of a model in a segment, whatever its orientation.
///
/// *Cost*: some ten milliseconds; more for a segment that may be a small part of the model.
///
/// # Errors
/// When the model comes to lie nowhere on the segment.
pub fn estimate_pose(model: &PoseModel, view: &SegmentView) -> Result<ModelPose, Error> {
    let pair = (model, view);
    let elements = thinned(view.surface.surfels(), N_COARSE_ELEMENTS);
    let coarse = Stage {
        detail: ScoreDetail {
            elements: &elements,
            stride: COARSE_STRIDE,
            tolerance_m: tolerance_m(view, COARSE_TOLERANCE_M),
        },
        schedule: coarse_schedule(model),
        uses_grid: true,
    };
    let aligned = least(align_all(&best_starts(pair), pair, &coarse), N_REFINED);
    let elements = thinned(view.surface.surfels(), N_FINE_ELEMENTS);
    let fine = Stage {
        detail: ScoreDetail {
            elements: &elements,
            stride: 1,
            tolerance_m: tolerance_m(view, FINE_TOLERANCE_M),
        },
        schedule: FINE_SCHEDULE,
        uses_grid: false,
    };
    let refined = least(align_all(&aligned, pair, &fine), 1);
    let (contradiction, camera_from_model) = *refined.first().ok_or(Error::NoOverlap {
        reach_mm: (1e3 * FINE_SCHEDULE.reach_m[0]) as u32,
    })?;
    Ok(ModelPose {
        camera_from_model,
        contradiction,
    })
}

/// Poses in which a template lies on the segment that contradict the camera least: branch and
/// bound, in the order of the contradictions of the segment alone.
fn best_starts((model, view): Pair<'_>) -> Vec<Scored> {
    let elements = thinned(view.surface.surfels(), N_START_ELEMENTS);
    let share_m = START_TOLERANCE * model.diameter_m;
    let share_m = share_m.clamp(*START_TOLERANCE_M.start(), *START_TOLERANCE_M.end());
    let detail = ScoreDetail {
        elements: &elements,
        stride: START_STRIDE,
        tolerance_m: tolerance_m(view, share_m),
    };
    let places: Vec<Point3<f64>> = elements.iter().map(|element| element.place).collect();
    let (_, spread_m) = centroid_and_spread(places.iter());
    let centre = view.surface.centroid();
    let starts = model.templates.iter().flat_map(|template| {
        let poses = template.poses_at(centre, spread_m);
        poses.map(move |pose| (template, pose))
    });
    let bounded = starts.map(|(template, pose)| {
        let bound = segment_contradiction(&pose, model, &detail);
        (bound, template, pose)
    });
    let mut bounded: Vec<(f64, &ViewTemplate, Isometry3<f64>)> = bounded.collect();
    bounded.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Vec<Scored> = Vec::new();
    for (bound, template, pose) in bounded {
        let is_full = best.len() == N_ALIGNED;
        if is_full && best.last().is_some_and(|(worst, _)| bound >= *worst) {
            break;
        }
        let score = bound + model_contradiction(&pose, template, view, &detail);
        let place = best.partition_point(|(other, _)| *other <= score);
        best.insert(place, (score, pose));
        best.truncate(N_ALIGNED);
    }
    best
}

/// Aligns poses in a stage, and scores them anew; those without overlap are left out.
fn align_all(starts: &[Scored], (model, view): Pair<'_>, stage: &Stage<'_>) -> Vec<Scored> {
    let centre = view.surface.centroid();
    let align = |(_, start): &Scored| {
        let model_from_camera = start.inverse();
        let aligner = Aligner {
            target: &model.surface,
            source: stage.detail.elements,
            centre,
            prior: Prior {
                target_from_source: model_from_camera,
                translation_sigma_m: PRIOR_SHARE * model.diameter_m,
                rotation_sigma_rad: PRIOR_RAD,
            },
            held: None,
            grid: stage.uses_grid.then_some(&model.nearest),
        };
        let alignment = aligner.align(model_from_camera, &stage.schedule);
        let pose = alignment.target_from_source.inverse();
        let template = ViewTemplate::seen_at(&model.templates, &pose, &centre)?;
        let score = contradiction(&pose, template, (model, view), &stage.detail);
        alignment.has_overlap().then_some((score, pose))
    };
    starts.iter().filter_map(align).collect()
}

/// First alignments: from the distance of neighbouring directions on.
fn coarse_schedule(model: &PoseModel) -> Schedule {
    let reach_m = REACH_SHARE * model.diameter_m;
    Schedule {
        n_steps: 8,
        reach_m: [reach_m.clamp(0.015, 0.05), 0.010],
        factor: 0.8,
        rotation_min_rad: 2e-3,
    }
}

/// Tolerance of a score that is no less than the noise of the segment, metres.
fn tolerance_m(view: &SegmentView, at_least_m: f64) -> f64 {
    at_least_m.max(TOLERANCE_SIGMAS * view.surface.noise_m())
}

/// Poses with the least contradictions, in their order.
fn least(mut poses: Vec<Scored>, n_wanted: usize) -> Vec<Scored> {
    poses.sort_by(|a, b| a.0.total_cmp(&b.0));
    poses.truncate(n_wanted);
    poses
}
