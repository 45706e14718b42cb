//! Grasp plan as a JSON document.

use crate::transit_document::PathDocument;
use geometry::RigidTransform;
use grasping::{ContactEvidence, Grasp, GraspPlan, GraspScene, RejectedGrasp, ScoreFactors};
use message::CategoryAnswer;
use nalgebra::{Translation3, Vector3};
use scene_client::{PlanningFrame, Snapshot};
use serde::Serialize;
use std::collections::BTreeMap;

/// Grasps of an object.
#[derive(Debug, Serialize)]
pub(crate) struct GraspDocument {
    pub(crate) track_id: u64,
    pub(crate) label: Option<String>,
    pub(crate) answer: CategoryAnswer,
    /// `model` or `measured`.
    pub(crate) source: &'static str,
    /// Sentence about why there is no grasp; `None` with one.
    pub(crate) sentence: Option<String>,
    /// Grasps, best first.
    pub(crate) grasps: Vec<PlannedGrasp>,
    /// Reasons of the rejected grasps with their numbers, first of those that came farthest.
    pub(crate) reasons: Vec<RejectionCount>,
    pub(crate) rejected: Vec<RejectedDocument>,
    /// Path of the arm from where it stands to the begin of the first grasp's approach.
    pub(crate) path: Option<PathDocument>,
    pub(crate) frame_sequence: u64,
    pub(crate) source_name: String,
    pub(crate) has_world_pose: bool,
    pub(crate) notes: Vec<String>,
    pub(crate) processing_ms: f64,
}

/// Grasp with its pose in the world.
#[derive(Debug, Serialize)]
pub(crate) struct PlannedGrasp {
    pub(crate) score: f64,
    /// `from above`, `slanted` or `from the side`.
    pub(crate) approach: &'static str,
    pub(crate) position_m: [f64; 3],
    pub(crate) orientation_xyzw: [f64; 4],
    /// Begin of the straight approach, and end of the straight way up.
    pub(crate) approach_position_m: [f64; 3],
    pub(crate) lift_position_m: [f64; 3],
    pub(crate) opening_mm: f64,
    pub(crate) width_mm: f64,
    /// `model`, `seen`, `contour` or `mirrored`: the weaker evidence of both contacts.
    pub(crate) evidence: &'static str,
    /// Factors of the score, 0 to 1.
    pub(crate) factors: BTreeMap<String, f64>,
    /// Joint angles at the begin of the approach, at the grasp and after the lift.
    pub(crate) approach_rad: Option<[f64; 6]>,
    pub(crate) grasp_rad: Option<[f64; 6]>,
    pub(crate) lift_rad: Option<[f64; 6]>,
}

/// Number of grasps that were rejected for a reason.
#[derive(Debug, Serialize)]
pub(crate) struct RejectionCount {
    pub(crate) reason: String,
    pub(crate) n_grasps: usize,
}

/// Rejected grasp.
#[derive(Debug, Serialize)]
pub(crate) struct RejectedDocument {
    pub(crate) reason: String,
    pub(crate) position_m: [f64; 3],
    pub(crate) orientation_xyzw: [f64; 4],
}

/// Document of the grasps of an object of a snapshot.
pub(crate) fn document(
    snapshot: &Snapshot,
    object: usize,
    (scene, plan): (&GraspScene<'_>, &GraspPlan),
    frame: &PlanningFrame,
) -> GraspDocument {
    let seen = &snapshot.objects[object];
    let reasons = plan.reasons(scene).into_iter();
    GraspDocument {
        track_id: seen.track,
        label: seen.label.clone(),
        answer: seen.answer(),
        source: if scene.objects[object].model.is_empty() {
            "measured"
        } else {
            "model"
        },
        sentence: plan.why_none(scene, seen.track),
        grasps: plan
            .grasps
            .iter()
            .map(|grasp| planned(grasp, frame))
            .collect(),
        reasons: reasons
            .map(|(reason, n_grasps)| RejectionCount { reason, n_grasps })
            .collect(),
        rejected: plan
            .rejected
            .iter()
            .map(|rejected| rejection(rejected, scene, frame))
            .collect(),
        path: None,
        frame_sequence: snapshot.sequence,
        source_name: snapshot.source_name.clone(),
        has_world_pose: snapshot.world_from_camera.is_some(),
        notes: Vec::new(),
        processing_ms: 0.0,
    }
}

/// Document of a grasp.
pub(crate) fn planned(grasp: &Grasp, frame: &PlanningFrame) -> PlannedGrasp {
    let pose = frame.world_from_plan * grasp.plan_from_tool;
    let back = Translation3::new(0.0, 0.0, -grasp.approach_m);
    let up = Translation3::from(Vector3::z() * grasp.lift_m);
    let lifted = frame.world_from_plan * (up * grasp.plan_from_tool);
    let joints = grasp.joints.as_ref();
    PlannedGrasp {
        score: grasp.score,
        approach: grasp.kind().words(),
        position_m: position(&pose),
        orientation_xyzw: pose.rotation.coords.into(),
        approach_position_m: position(&(pose * back)),
        lift_position_m: position(&lifted),
        opening_mm: 1e3 * grasp.opening_m,
        width_mm: 1e3 * grasp.width_m,
        evidence: evidence_word(grasp.evidence),
        factors: factors(&grasp.factors),
        approach_rad: joints.map(|joints| joints.approach_rad.into()),
        grasp_rad: joints.map(|joints| joints.grasp_rad.into()),
        lift_rad: joints.map(|joints| joints.lift_rad.into()),
    }
}

/// Factors by keys without spaces.
fn factors(factors: &ScoreFactors) -> BTreeMap<String, f64> {
    let named = factors.by_name().into_iter();
    named
        .map(|(name, value)| (name.replace(' ', "_"), value))
        .collect()
}

fn rejection(
    rejected: &RejectedGrasp,
    scene: &GraspScene<'_>,
    frame: &PlanningFrame,
) -> RejectedDocument {
    let pose = frame.world_from_plan * rejected.plan_from_tool;
    RejectedDocument {
        reason: rejected.reason.words(scene),
        position_m: position(&pose),
        orientation_xyzw: pose.rotation.coords.into(),
    }
}

fn position(pose: &RigidTransform) -> [f64; 3] {
    pose.translation.vector.into()
}

fn evidence_word(evidence: ContactEvidence) -> &'static str {
    match evidence {
        ContactEvidence::Model => "model",
        ContactEvidence::Seen => "seen",
        ContactEvidence::Contour => "contour",
        ContactEvidence::Mirrored => "mirrored",
    }
}
