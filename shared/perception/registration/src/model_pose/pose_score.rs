//! Score of a pose of a model: contradictions between the model and what the camera saw.

use super::view_template::ViewTemplate;
use super::{PoseModel, SegmentView};
use crate::surfels::Surfel;
use nalgebra::{Isometry3, Point3};

/// Weight of what is hidden, or not measured, which neither agrees nor contradicts. Chosen: a
/// pose must not win by hiding everything.
const HIDDEN_WEIGHT: f64 = 0.25;

/// Distance from a surfel along the surface up to which a place is at it, metres: the distance of
/// neighbouring surfels, and the cells of the grid in which they are looked up.
const ALONG_M: f64 = 0.008;

/// Cost of a place at a measured surface that is not of the segment: another object, or a part of
/// this one that detection cut off. Chosen.
const ELSEWHERE_COST: f64 = 0.5;

/// Detail of a score: elements of the segment, stride over the points of a template, and
/// tolerance, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScoreDetail<'a> {
    pub(super) elements: &'a [Surfel],
    pub(super) stride: usize,
    pub(super) tolerance_m: f64,
}

/// Contradiction of a pose `camera_from_model` that shows the template to the camera, 0 to 2.
pub(super) fn contradiction(
    pose: &Isometry3<f64>,
    template: &ViewTemplate,
    (model, view): (&PoseModel, &SegmentView),
    detail: &ScoreDetail<'_>,
) -> f64 {
    segment_contradiction(pose, model, detail) + model_contradiction(pose, template, view, detail)
}

/// Mean over the segment of 0 for a place at the model and 1 for one that is off.
pub(super) fn segment_contradiction(
    camera_from_model: &Isometry3<f64>,
    model: &PoseModel,
    detail: &ScoreDetail<'_>,
) -> f64 {
    let model_from_camera = camera_from_model.inverse();
    let reach_m = detail.tolerance_m.max(ALONG_M);
    let cost = |element: &Surfel| {
        let place = model_from_camera * element.place;
        let Some(near) = model.nearest.near(model.surface.surfels(), &place) else {
            return 1.0;
        };
        let off = near.place - place;
        if off.norm_squared() > reach_m * reach_m {
            return 1.0;
        }
        let across = off.dot(&near.normal) / detail.tolerance_m;
        let cosine = (model_from_camera.rotation * element.normal).dot(&near.normal);
        (across * across + 0.5 * (1.0 - cosine.abs())).min(1.0)
    };
    let n = detail.elements.len().max(1) as f64;
    detail.elements.iter().map(cost).sum::<f64>() / n
}

/// Mean over the parts that the camera should have seen of the model of 0 for a place that it saw
/// there and 1 for one behind which it saw something.
pub(super) fn model_contradiction(
    camera_from_model: &Isometry3<f64>,
    template: &ViewTemplate,
    view: &SegmentView,
    detail: &ScoreDetail<'_>,
) -> f64 {
    let (mut sum, mut weights) = (0.0, f64::EPSILON);
    for point in template.points.iter().step_by(detail.stride) {
        let place = camera_from_model * point;
        let (cost, weight) = model_point_cost(view, &place, detail.tolerance_m);
        sum += weight * cost;
        weights += weight;
    }
    sum / weights
}

/// Cost and weight of a place that the camera should have seen of the model.
fn model_point_cost(view: &SegmentView, place: &Point3<f64>, tolerance_m: f64) -> (f64, f64) {
    match view.scene.height_above(place) {
        None => (0.0, HIDDEN_WEIGHT),
        Some(above) if above > tolerance_m => (0.0, HIDDEN_WEIGHT),
        Some(above) if above < -tolerance_m => (1.0, 1.0),
        Some(_) => {
            let nearest = view.surface.nearest_surfel(place, 2.0 * tolerance_m);
            (
                if nearest.is_some() {
                    0.0
                } else {
                    ELSEWHERE_COST
                },
                1.0,
            )
        }
    }
}
