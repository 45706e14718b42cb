//! Accuracy of recognition and registration over the segments of all views.

use super::bin_scene::{BinObject, BinScene};
use super::captured_view::CapturedView;
use crate::evaluate::tabular_report::{ReportTable, percent};
use geometry::RigidTransform;
use nalgebra::{Point3, distance};
use registration::KdTree;
use serde::Serialize;

/// Share of the diameter that the nearest-point error of a right pose is below (Hinterstoisser et
/// al. 2012).
const RIGHT_SHARE: f64 = 0.1;
/// Number of the points of a model at which the error is measured, at least. Chosen.
const N_POINTS: usize = 400;

/// `true` if the mean distance of the points of an object's model in an estimated pose from the
/// nearest in the true one (ADD-S, Hinterstoisser et al. 2012) is below a tenth of the diameter.
pub(super) fn is_right(object: &BinObject, world_from_model: &RigidTransform) -> bool {
    let surface = object.surface.points();
    let tree = KdTree::new(surface);
    let true_from_estimated = object.world_from_object.inverse() * world_from_model;
    let points = surface.iter().step_by((surface.len() / N_POINTS).max(1));
    let points: Vec<Point3<f64>> = points.map(|point| Point3::from(*point).cast()).collect();
    let error_m = |point: &Point3<f64>| {
        let place = true_from_estimated * point;
        let nearest = tree.nearest(place.cast::<f32>().into(), f32::INFINITY);
        nearest.map_or(f64::INFINITY, |(_, squared)| f64::from(squared).sqrt())
    };
    let others = |a: &Point3<f64>| points.iter().map(|b| distance(a, b)).fold(0.0, f64::max);
    let diameter_m = points.iter().map(others).fold(0.0, f64::max);
    points.iter().map(error_m).sum::<f64>() < RIGHT_SHARE * diameter_m * points.len() as f64
}

/// Counts of segments.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct PoseCounts {
    /// Segments of all views.
    pub(super) n_segments: usize,
    /// Those that cover an object.
    pub(super) n_objects: usize,
    /// Of these, those that are recognised.
    pub(super) n_recognised: usize,
    /// Those that are identified by recognition and registration.
    pub(super) n_identified: usize,
    /// Those on which the true model, when it is given, fits at a right pose: ADD-S below 0.1 of
    /// its diameter.
    pub(super) n_true_model_right: usize,
    /// Segments of all kinds on which a model was placed.
    pub(super) n_good: usize,
    /// Of these, those with the right model at a right pose.
    pub(super) n_good_right: usize,
}

impl PoseCounts {
    /// Counts over the views of a scene.
    pub(super) fn of(scene: &BinScene, views: &[CapturedView]) -> Self {
        let mut counts = Self::default();
        for segment in views.iter().flat_map(|view| &view.segments.segments) {
            let count = usize::from;
            counts.n_segments += 1;
            counts.n_objects += count(segment.object.is_some());
            counts.n_recognised += count(segment.is_recognised(scene));
            counts.n_identified += count(segment.is_identified(scene));
            counts.n_true_model_right += count(segment.is_true_model_right);
            let model = segment.registered.as_ref();
            counts.n_good += count(model.is_some());
            counts.n_good_right += count(model.is_some_and(|model| model.is_right));
        }
        counts
    }

    /// Sum of the counts of scenes.
    pub(super) fn sum(counts: impl Iterator<Item = Self>) -> Self {
        counts.fold(Self::default(), |a, b| Self {
            n_segments: a.n_segments + b.n_segments,
            n_objects: a.n_objects + b.n_objects,
            n_recognised: a.n_recognised + b.n_recognised,
            n_identified: a.n_identified + b.n_identified,
            n_true_model_right: a.n_true_model_right + b.n_true_model_right,
            n_good: a.n_good + b.n_good,
            n_good_right: a.n_good_right + b.n_good_right,
        })
    }

    /// Table of each count beside the number of which it is a part.
    pub(super) fn table(&self) -> ReportTable {
        let parts = [
            ("that cover an object", self.n_objects, self.n_segments),
            ("recognised", self.n_recognised, self.n_objects),
            (
                "identified by a model as well",
                self.n_identified,
                self.n_objects,
            ),
            (
                "true model at a right pose",
                self.n_true_model_right,
                self.n_objects,
            ),
            (
                "chosen model right, at a right pose",
                self.n_good_right,
                self.n_objects,
            ),
            (
                "with a model, which is right",
                self.n_good_right,
                self.n_good,
            ),
        ];
        ReportTable::of(
            "Recognition and registration",
            parts,
            &[
                ("segments", &|(name, ..)| (*name).to_owned()),
                ("number", &|(_, n, _)| n.to_string()),
                ("of them", &|(.., of)| of.to_string()),
                ("share %", &|(_, n, of)| {
                    percent(*n as f64 / (*of).max(1) as f64)
                }),
            ],
        )
    }
}
