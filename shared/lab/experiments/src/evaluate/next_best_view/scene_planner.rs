//! Planner of a scene: drives the libraries of `tabula view plan` on its images.

use super::bin_scene::BinScene;
use super::captured_view::LabelledImage;
use super::noisy_truth::noisy_truth;
use super::object_recognition::ObjectRecogniser;
use super::pose_accuracy::is_right;
use super::prediction_source::PredictionSource;
use super::scene_models::SceneModels;
use super::segment_matching::{MatchedSegments, RegisteredModel, SceneSegment};
use geometry::{Plane, RigidTransform};
use message::{SurfaceKind, TrackState};
use nalgebra::{Point3, Vector3};
use random::mix64;
use scene_client::{
    HypothesisSource, ModelShelf, ObjectHypothesis, PlanningFrame, SceneSurface, Snapshot,
    SnapshotObject,
};
use service::Failure;
use view_planning::{PlanContent, PlanSettings, rate};

/// Plans from one view.
#[derive(Debug, Default)]
pub(super) struct ViewPlans {
    /// Predicted entropy of the view from each camera, bit, by source of the hypotheses.
    pub(super) predicted: Vec<Vec<f64>>,
    /// Content of the plans by source of the hypotheses; empty where no views are chosen.
    pub(super) contents: Vec<PlanContent>,
}

/// Planner with the models of a scene and the recogniser of its objects.
pub(super) struct ScenePlanner<'a> {
    scene: &'a BinScene,
    /// Recogniser; without one all models are alike.
    recogniser: Option<ObjectRecogniser>,
    shelf: ModelShelf,
    /// Seed of the noise of hypotheses.
    seed: u64,
    /// `true` to keep the contents of plans, from which views are chosen.
    keeps_contents: bool,
}

impl<'a> ScenePlanner<'a> {
    /// Planner of a scene, which reads all its models at once.
    pub(super) fn new(
        scene: &'a BinScene,
        recogniser: Option<ObjectRecogniser>,
        seed: u64,
        keeps_contents: bool,
    ) -> Result<Self, Failure> {
        let mut of_all = Snapshot::of_points(super::captured_view::CAMERA, Vec::new());
        let object = |name: &str| {
            object(
                0,
                Some(name),
                &[[0.0, 0.0, 1.0]],
                &RigidTransform::identity(),
            )
        };
        of_all.objects = scene.models().map(|model| object(&model.name)).collect();
        let mut shelf = ModelShelf::default();
        shelf.refresh(&of_all, || Ok(SceneModels(scene)))?;
        Ok(Self {
            scene,
            recogniser,
            shelf,
            seed,
            keeps_contents,
        })
    }

    /// Recognises the segments of an image, places models on them, and predicts the entropy of all
    /// views.
    pub(super) fn plan(
        &self,
        image: &LabelledImage<'_>,
        segments: &mut MatchedSegments,
        number: usize,
    ) -> Result<ViewPlans, Failure> {
        for segment in &mut segments.segments {
            (segment.label, segment.categories) = self.recognised(segment);
            segment.descriptors = None;
        }
        let snapshot = snapshot(image, segments);
        let frame = PlanningFrame::of(&snapshot).ok_or_else(|| {
            Failure::general(format!(
                "view {number} shows no object, and nothing in the middle of the image, so that no \
                 view can be planned from it"
            ))
        })?;
        let cameras = frame.poses(&self.scene.cameras);
        let seed = mix64(self.seed ^ mix64(number as u64));
        let mut plans = ViewPlans::default();
        for source in PredictionSource::ALL {
            let frame = frame.clone();
            let content = if let Some(noise) = source.noise() {
                let truth = noisy_truth(self.scene, noise, seed, &frame);
                let content =
                    PlanContent::with_hypotheses(&snapshot, frame, truth, self.keeps_contents);
                self.with_surroundings(content?)
            } else {
                PlanContent::of(&snapshot, frame, &self.shelf, self.keeps_contents)?
            };
            let settings = PlanSettings {
                gain_weight: 0.0,
                ..PlanSettings::default()
            };
            let scores = rate(&content, &cameras, &[], &settings)?;
            plans
                .predicted
                .push(scores.iter().map(|score| score.entropy).collect());
            if source == PredictionSource::Registered {
                self.note_models(&snapshot, &content, segments);
            }
            if self.keeps_contents {
                plans.contents.push(content);
            }
        }
        Ok(plans)
    }

    /// Adds the known surroundings to the content of a bound.
    fn with_surroundings(&self, mut content: PlanContent) -> PlanContent {
        let plan_from_world = content.frame.world_from_plan.inverse();
        let place = |point: &[f32; 3]| plan_from_world * Point3::from(*point).cast::<f64>();
        let places = self.scene.surroundings.iter().map(place);
        let points: Vec<[f32; 3]> = places.map(|place| place.cast::<f32>().into()).collect();
        content.background.extend(points);
        content
    }

    /// Label of a segment and its most probable categories, as perception publishes them. Without
    /// a recogniser it may be any model.
    fn recognised(&self, segment: &SceneSegment) -> (Option<String>, Vec<(String, f64)>) {
        if let Some(recogniser) = &self.recogniser {
            return recogniser.recognise(segment.descriptors.as_ref());
        }
        let names: Vec<String> = self
            .scene
            .models()
            .map(|model| model.name.clone())
            .collect();
        let share = 1.0 / names.len().max(1) as f64;
        let label = names.first().cloned();
        (label, names.into_iter().map(|name| (name, share)).collect())
    }

    /// Notes the models that were placed on the segments, and whether they are right.
    fn note_models(
        &self,
        snapshot: &Snapshot,
        content: &PlanContent,
        segments: &mut MatchedSegments,
    ) {
        let around = snapshot.thinned();
        let placed = segments.segments.iter_mut().zip(&content.hypotheses);
        for ((segment, hypothesis), seen) in placed.zip(&snapshot.objects) {
            let covered = segment.object.map(|object| &self.scene.objects[object]);
            segment.registered = registered(hypothesis, &content.frame).map(|(name, pose)| {
                let its = covered.filter(|object| object.name == name);
                let is_right = its.is_some_and(|object| is_right(object, &pose));
                RegisteredModel { name, is_right }
            });
            segment.is_true_model_right = covered.is_some_and(|object| {
                let alone = SnapshotObject {
                    label: Some(object.name.clone()),
                    categories: Vec::new(),
                    ..seen.clone()
                };
                let placed = self.shelf.place(&alone, &around);
                let pose = placed
                    .ok()
                    .flatten()
                    .map(|placed| placed.pose.camera_from_model);
                pose.is_some_and(|pose| is_right(object, &(snapshot.pose() * pose)))
            });
        }
    }
}

/// Model of a hypothesis with its pose in the world; `None` for measured points.
fn registered(
    hypothesis: &ObjectHypothesis,
    frame: &PlanningFrame,
) -> Option<(String, RigidTransform)> {
    match &hypothesis.source {
        HypothesisSource::Measured => None,
        HypothesisSource::Model { name, .. } => {
            let pose = frame.world_from_plan * hypothesis.plan_from_object;
            Some((name.clone(), pose))
        }
    }
}

/// Snapshot of an image with its segments as objects.
fn snapshot(image: &LabelledImage<'_>, segments: &MatchedSegments) -> Snapshot {
    let pose = &image.world_from_camera;
    let objects = segments.segments.iter().zip(1..).map(|(segment, track)| {
        let categories = segment.categories.clone();
        let label = segment.label.as_deref();
        SnapshotObject {
            categories,
            ..object(track, label, &segment.in_camera, pose)
        }
    });
    let table = segments.table_in_camera;
    Snapshot {
        world_from_camera: Some(*pose),
        up_in_camera: image.up_in_camera,
        surfaces: table
            .map(|table| surface(table, pose))
            .into_iter()
            .collect(),
        objects: objects.collect(),
        ..Snapshot::of_points(image.camera, image.points.to_vec())
    }
}

/// Table of a plane, of whose outline nothing is known.
fn surface(plane_in_camera: Plane, world_from_camera: &RigidTransform) -> SceneSurface {
    SceneSurface {
        kind: SurfaceKind::Table,
        plane_in_world: plane_in_camera.transformed(world_from_camera),
        corners_in_world: Vec::new(),
    }
}

/// Tracked object of measured points.
fn object(
    track: u64,
    label: Option<&str>,
    in_camera: &[[f32; 3]],
    world_from_camera: &RigidTransform,
) -> SnapshotObject {
    let places = in_camera
        .iter()
        .map(|point| Vector3::from(*point).cast::<f64>());
    let middle = places.sum::<Vector3<f64>>() / in_camera.len().max(1) as f64;
    SnapshotObject {
        track,
        label: label.map(str::to_owned),
        categories: Vec::new(),
        state: TrackState::Tracked,
        middle_in_world: world_from_camera * Point3::from(middle),
        points: in_camera.to_vec(),
    }
}
