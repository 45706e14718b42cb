//! Plan of the next best view as a JSON document.

use super::motion::Motion;
use geometry::RigidTransform;
use message::CategoryAnswer;
use nalgebra::Vector3;
use next_best_view::ChoiceReason;
use scene_client::{HypothesisSource, ObjectHypothesis, Snapshot, SnapshotObject};
use serde::Serialize;
use view_planning::{RatedView, ViewPlan};

/// Plan of the next best view.
#[derive(Debug, Serialize)]
pub(crate) struct PlanDocument {
    pub(crate) chosen: ViewDocument,
    pub(crate) reason: &'static str,
    pub(crate) motion: String,
    pub(crate) present: ViewDocument,
    /// Candidates in their order.
    pub(crate) views: Vec<ViewDocument>,
    pub(crate) hypotheses: Vec<HypothesisDocument>,
    pub(crate) objects: Vec<PlannedObject>,
    pub(crate) n_background_points: usize,
    pub(crate) n_unknown_voxels: usize,
    pub(crate) n_visited: usize,
    pub(crate) frame_sequence: u64,
    pub(crate) source_name: String,
    pub(crate) has_world_pose: bool,
    pub(crate) is_published: bool,
    pub(crate) notes: Vec<String>,
    pub(crate) processing_ms: f64,
}

/// Rated camera pose.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ViewDocument {
    /// Index among the candidates; `None` for the present view.
    pub(crate) index: Option<usize>,
    pub(crate) rank: Option<usize>,
    pub(crate) state: &'static str,
    pub(crate) position_m: [f64; 3],
    pub(crate) orientation_xyzw: [f64; 4],
    /// Direction of sight, unit vector.
    pub(crate) direction: [f64; 3],
    /// Angle at which the camera looks down, degrees.
    pub(crate) down_deg: f64,
    pub(crate) entropy: f64,
    pub(crate) gain: f64,
    pub(crate) weight: f64,
    pub(crate) utility: f64,
    pub(crate) n_objects_seen: usize,
    /// Way and turn from the present pose.
    pub(crate) distance_m: f64,
    pub(crate) angle_deg: f64,
}

/// Hypothesis of an object.
#[derive(Debug, Serialize)]
pub(crate) struct HypothesisDocument {
    pub(crate) track_id: u64,
    pub(crate) label: Option<String>,
    pub(crate) answer: CategoryAnswer,
    /// `model` or `measured`.
    pub(crate) source: &'static str,
    /// Contradiction of the model's pose: 0 for a perfect fit, up to 2.
    pub(crate) contradiction: Option<f64>,
    pub(crate) position_m: [f64; 3],
    pub(crate) orientation_xyzw: [f64; 4],
    pub(crate) n_points: usize,
    /// Visible share from the present pose and from the chosen one, 0 to 1.
    pub(crate) visible_now: f64,
    pub(crate) visible_then: f64,
    pub(crate) note: String,
}

/// Object of the scene.
#[derive(Debug, Serialize)]
pub(crate) struct PlannedObject {
    pub(crate) track_id: u64,
    pub(crate) label: Option<String>,
    pub(crate) answer: CategoryAnswer,
    pub(crate) state: &'static str,
    /// True if there is a hypothesis of it.
    pub(crate) is_planned_for: bool,
}

/// Word of a reason.
pub(crate) fn reason_word(reason: ChoiceReason) -> &'static str {
    match reason {
        ChoiceReason::Utility => "utility",
        ChoiceReason::InformationGain => "information-gain",
        ChoiceReason::Distance => "distance",
    }
}

/// Documents of the candidates in their order, and of the present view.
pub(crate) fn views(
    plan: &ViewPlan,
    world_from_plan: &RigidTransform,
) -> (Vec<ViewDocument>, ViewDocument) {
    let present = plan.present.plan_from_camera;
    let document = |index: Option<usize>, view: &RatedView| {
        let pose = world_from_plan * view.plan_from_camera;
        let motion = Motion::new(present, view.plan_from_camera);
        let axis_in_plan = view.plan_from_camera.rotation * Vector3::z();
        ViewDocument {
            index,
            rank: view.rank,
            state: view.state.word(),
            position_m: pose.translation.vector.into(),
            orientation_xyzw: pose.rotation.coords.into(),
            direction: (pose.rotation * Vector3::z()).into(),
            down_deg: (-axis_in_plan.z).clamp(-1.0, 1.0).asin().to_degrees(),
            entropy: view.score.entropy,
            gain: view.score.gain,
            weight: view.score.weight,
            utility: view.score.utility,
            n_objects_seen: view.n_objects_seen,
            distance_m: motion.distance_m(),
            angle_deg: motion.angle_deg(),
        }
    };
    let numbered = plan.views.iter().enumerate();
    let views = numbered.map(|(index, view)| document(Some(index), view));
    (views.collect(), document(None, &plan.present))
}

/// Documents of the hypotheses of a snapshot with their visible shares.
pub(crate) fn hypotheses(
    snapshot: &Snapshot,
    hypotheses: &[ObjectHypothesis],
    plan: &ViewPlan,
    world_from_plan: &RigidTransform,
) -> Vec<HypothesisDocument> {
    let document = |(hypothesis, [now, then]): (&ObjectHypothesis, &[f64; 2])| {
        let pose = world_from_plan * hypothesis.plan_from_object;
        let (source, contradiction) = match &hypothesis.source {
            HypothesisSource::Measured => ("measured", None),
            HypothesisSource::Model { contradiction, .. } => ("model", Some(*contradiction)),
        };
        HypothesisDocument {
            track_id: hypothesis.track,
            label: hypothesis.label.clone(),
            answer: answer_about(snapshot, hypothesis.track),
            source,
            contradiction,
            position_m: pose.translation.vector.into(),
            orientation_xyzw: pose.rotation.coords.into(),
            n_points: hypothesis.surface.points().len(),
            visible_now: *now,
            visible_then: *then,
            note: hypothesis.note.clone(),
        }
    };
    hypotheses.iter().zip(&plan.shares).map(document).collect()
}

fn answer_about(snapshot: &Snapshot, track: u64) -> CategoryAnswer {
    let mut objects = snapshot.objects.iter();
    let object = objects.find(|object| object.track == track);
    object.map_or(CategoryAnswer::Unknown, SnapshotObject::answer)
}

/// Documents of the objects of a snapshot.
pub(crate) fn objects(snapshot: &Snapshot, hypotheses: &[ObjectHypothesis]) -> Vec<PlannedObject> {
    let is_planned_for = |track| hypotheses.iter().any(|h| h.track == track);
    let objects = snapshot.objects.iter();
    objects
        .map(|object| PlannedObject {
            track_id: object.track,
            label: object.label.clone(),
            answer: object.answer(),
            state: object.state.word(),
            is_planned_for: is_planned_for(object.track),
        })
        .collect()
}
