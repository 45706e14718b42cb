//! Object hypotheses of a snapshot: the stored model of an object in its estimated pose, or the
//! measured points of the object.

use crate::model_shelf::ModelShelf;
use crate::snapshot::{Snapshot, SnapshotObject};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use next_best_view::SurfaceModel;
use service::Failure;
use std::rc::Rc;

/// Object hypothesis of a track, in the frame of planning.
#[derive(Debug, Clone)]
pub struct ObjectHypothesis {
    /// Track-id.
    pub track: u64,
    /// Label of the track.
    pub label: Option<String>,
    /// Source of the surface.
    pub source: HypothesisSource,
    /// Surface of the object.
    pub surface: Rc<SurfaceModel>,
    /// Pose of the surface.
    pub plan_from_object: RigidTransform,
    /// Reason why no stored model is used, or that of another category; empty otherwise.
    pub note: String,
}

/// Source of the surface of a hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub enum HypothesisSource {
    /// Measured points of the track.
    Measured,
    /// Stored model.
    Model {
        /// Name of the model.
        name: String,
        /// Contradiction of its pose: 0 for a perfect fit, up to 2.
        contradiction: f64,
    },
}

/// Hypotheses of all objects with measured points, thinned to one point in each cell, in a frame
/// such as that of planning. The models on the shelf are those of the last refresh.
///
/// # Errors
/// When the points of an object make no surface.
pub fn hypotheses(
    shelf: &ModelShelf,
    snapshot: &Snapshot,
    plan_from_camera: &RigidTransform,
    cell_m: f64,
) -> Result<Vec<ObjectHypothesis>, Failure> {
    let scene = snapshot.thinned();
    let seen = snapshot.objects.iter().filter(|o| !o.points.is_empty());
    let hypothesis = |object: &SnapshotObject| {
        let measured = measured_hypothesis(object, plan_from_camera, cell_m)?;
        Ok(match shelf.place(object, &scene) {
            Ok(None) => measured,
            Err(reason) => ObjectHypothesis {
                note: format!("{reason}; its measured points are used"),
                ..measured
            },
            Ok(Some(placed)) => ObjectHypothesis {
                source: HypothesisSource::Model {
                    name: placed.name.to_owned(),
                    contradiction: placed.pose.contradiction,
                },
                surface: placed.surface.clone(),
                plan_from_object: plan_from_camera * placed.pose.camera_from_model,
                note: note_of_other(object, placed.name),
                ..measured
            },
        })
    };
    seen.map(hypothesis).collect()
}

/// Note that a model of another category than the label is used; empty for one of the label.
fn note_of_other(object: &SnapshotObject, model: &str) -> String {
    if object.label.as_deref() == Some(model) {
        return String::new();
    }
    format!("the stored model of {model:?} fits it best")
}

/// Hypothesis of the measured points of an object, about their middle.
fn measured_hypothesis(
    object: &SnapshotObject,
    plan_from_camera: &RigidTransform,
    cell_m: f64,
) -> Result<ObjectHypothesis, Failure> {
    let in_plan = |point: &[f32; 3]| plan_from_camera * Point3::from(*point).cast::<f64>();
    let n = object.points.len() as f64;
    let sum = object
        .points
        .iter()
        .fold(Vector3::zeros(), |sum, point| sum + in_plan(point).coords);
    let middle = sum / n;
    let about_middle = |point: &[f32; 3]| (in_plan(point).coords - middle).cast::<f32>().into();
    let points: Vec<[f32; 3]> = object.points.iter().map(about_middle).collect();
    let surface = SurfaceModel::of_points(&points, cell_m).map_err(|error| {
        let track = object.track;
        Failure::general(format!(
            "the points of object {track} cannot be used: {error}"
        ))
    })?;
    Ok(ObjectHypothesis {
        track: object.track,
        label: object.label.clone(),
        source: HypothesisSource::Measured,
        surface: Rc::new(surface),
        plan_from_object: RigidTransform::translation(middle.x, middle.y, middle.z),
        note: String::new(),
    })
}
