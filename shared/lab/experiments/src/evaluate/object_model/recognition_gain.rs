//! Gain of recognition by a model: sides that were never taught are recognised by its views.

use super::orbit::{Orbit, OrbitView};
use super::trial::FusedView;
use crate::frame_detector::up_in_camera;
use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
use learning::{CategoryIndex, CategoryName, ViewId};
use nalgebra::Vector3;
use serde::Serialize;
use service::Failure;

/// Number of taught views: of one side, next to each other.
const N_LESSONS: usize = 3;

/// Angle about the vertical from the taught side beyond which a side was never taught, degrees.
const NEVER_SHOWN_DEG: f64 = 60.0;

/// Descriptors of the axis hypotheses of one view.
type ViewDescriptors = Vec<Vec<f32>>;

/// Described views of one object.
#[derive(Debug, Default)]
pub(super) struct DescribedObject {
    /// Views of one side.
    lessons: Vec<ViewDescriptors>,
    /// Views that the model is made of.
    of_model: Vec<ViewDescriptors>,
    /// Views of sides that the lessons do not show, from another path.
    questions: Vec<ViewDescriptors>,
}

/// Accuracy of recognition of never taught sides, means over the objects.
#[derive(Debug, Serialize)]
pub(super) struct RecognitionGain {
    pub(super) n_objects: usize,
    pub(super) n_questions: usize,
    /// After three taught views of one side of each object.
    pub(super) accuracy_before: f64,
    /// With the views of the models as well.
    pub(super) accuracy_after: f64,
}

impl DescribedObject {
    /// Describes the first views of an orbit as lessons, the fused ones as those of the model, and
    /// those of another path from other sides as questions.
    pub(super) fn new(orbit: &Orbit, fused: &[FusedView], other: &Orbit) -> Result<Self, Failure> {
        let mut descriptor =
            AppearanceDescriptor::new(AppearanceWeights::default()).map_err(Failure::general)?;
        let mut described = |views: Vec<&OrbitView>| -> Vec<ViewDescriptors> {
            let views = views.into_iter();
            views
                .filter_map(|view| describe(&mut descriptor, view))
                .collect()
        };
        let side = orbit.views.first().map(|view| azimuth(orbit, view));
        let is_other_side = |view: &&OrbitView| {
            side.is_some_and(|side| {
                azimuth(other, view).angle(&side).to_degrees() > NEVER_SHOWN_DEG
            })
        };
        let is_fused = |view: &&OrbitView| {
            let mut all = fused.iter();
            all.any(|fused| fused.captured_ns == view.captured_ns)
        };
        Ok(Self {
            lessons: described(orbit.views.iter().take(N_LESSONS).collect()),
            of_model: described(orbit.views.iter().filter(is_fused).collect()),
            questions: described(other.views.iter().filter(is_other_side).collect()),
        })
    }
}

impl RecognitionGain {
    /// Accuracy over objects that are told from each other.
    pub(super) fn of(objects: &[DescribedObject]) -> Result<Self, Failure> {
        Ok(Self {
            n_objects: objects.len(),
            n_questions: objects.iter().map(|object| object.questions.len()).sum(),
            accuracy_before: accuracy(objects, |object| vec![&object.lessons])?,
            accuracy_after: accuracy(objects, |object| vec![&object.lessons, &object.of_model])?,
        })
    }
}

/// Horizontal direction from the object to the camera of a view.
fn azimuth(orbit: &Orbit, view: &OrbitView) -> Vector3<f64> {
    let centre = orbit.world_from_object.translation.vector;
    let direction = view.world_from_camera.translation.vector - centre;
    Vector3::new(direction.x, direction.y, 0.0)
}

fn describe(descriptor: &mut AppearanceDescriptor, view: &OrbitView) -> Option<ViewDescriptors> {
    let up = up_in_camera(&view.world_from_camera, &Vector3::z_axis());
    let found = descriptor
        .describe(ObjectPoints::all(&view.points), Some(&up))
        .ok()?;
    Some(found.to_vec())
}

/// Share of the rightly recognised questions of an object, mean over the objects.
fn accuracy(
    objects: &[DescribedObject],
    taught: impl Fn(&DescribedObject) -> Vec<&Vec<ViewDescriptors>>,
) -> Result<f64, Failure> {
    let mut index = pipeline::category_index();
    for (number, object) in objects.iter().enumerate() {
        let views = taught(object).into_iter().flatten();
        for (view_id, view) in views.enumerate() {
            let id = ViewId {
                track_id: number as u64,
                view_id: view_id as u32,
            };
            index
                .insert(id, &name(number)?, &view[0])
                .map_err(Failure::general)?;
        }
    }
    let mut shares = Vec::new();
    for (number, object) in objects.iter().enumerate() {
        let right = object
            .questions
            .iter()
            .filter(|view| is_right(&index, view, number));
        if !object.questions.is_empty() {
            shares.push(right.count() as f64 / object.questions.len() as f64);
        }
    }
    Ok(shares.iter().sum::<f64>() / shares.len() as f64)
}

fn name(number: usize) -> Result<CategoryName, Failure> {
    CategoryName::new(&number.to_string()).map_err(Failure::general)
}

/// `true` if a view is taken for the object of a number; no view is withheld as unknown.
fn is_right(index: &CategoryIndex, view: &ViewDescriptors, number: usize) -> bool {
    let found = index.recognise_any(view, f32::INFINITY).ok();
    let nearest = found.and_then(|found| found.nearest.into_iter().next().flatten());
    nearest.is_some_and(|nearest| nearest.view.track_id == number as u64)
}
