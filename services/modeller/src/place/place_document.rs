//! Plan of a transport as a JSON document.

use crate::grasp::grasp_document::{PlannedGrasp, planned};
use crate::transit_document::{PathDocument, path};
use arm_kinematics::Arm;
use grasping::GraspPlan;
use message::CategoryAnswer;
use nalgebra::{Point3, Translation3, Vector3};
use scene_client::{PlanningFrame, Snapshot};
use serde::Serialize;
use transport::{PlacePose, Transport};

/// Plan of a transport.
#[derive(Debug, Serialize)]
pub(super) struct PlaceDocument {
    pub(super) track_id: u64,
    pub(super) label: Option<String>,
    pub(super) answer: CategoryAnswer,
    /// Name of the place.
    pub(super) place: String,
    /// Sentence about why it is not possible; `None` when it is.
    pub(super) sentence: Option<String>,
    pub(super) transport: Option<TransportDocument>,
    pub(super) frame_sequence: u64,
    pub(super) source_name: String,
    pub(super) notes: Vec<String>,
    pub(super) processing_ms: f64,
}

/// Motions of a transport, in their order.
#[derive(Debug, Serialize)]
pub(super) struct TransportDocument {
    /// Path from where the arm stands to the begin of the approach.
    pub(super) to_grasp: PathDocument,
    pub(super) grasp: PlannedGrasp,
    /// Path with the object from the end of the lift to over the place.
    pub(super) to_place: PathDocument,
    pub(super) placement: PlacementDocument,
}

/// Pose in which the object is set down.
#[derive(Debug, Serialize)]
pub(super) struct PlacementDocument {
    /// Middle of the object's foot, world.
    pub(super) foot_m: [f64; 3],
    /// Turn of the object about the vertical.
    pub(super) turn_deg: f64,
    /// Surface on which it then stands.
    pub(super) surface: String,
    /// Pose of the gripper when the fingers open, world.
    pub(super) position_m: [f64; 3],
    pub(super) orientation_xyzw: [f64; 4],
    /// Begin of the straight way down, and end of the straight way back.
    pub(super) above_position_m: [f64; 3],
    pub(super) retreat_position_m: [f64; 3],
    pub(super) opening_mm: f64,
    /// Joint angles over the place, at the release and after the way back.
    pub(super) above_rad: [f64; 6],
    pub(super) release_rad: [f64; 6],
    pub(super) retreat_rad: [f64; 6],
}

impl PlaceDocument {
    /// Document about an object of a snapshot, without a plan.
    pub(super) fn new(snapshot: &Snapshot, object: usize, place: &str) -> Self {
        let seen = &snapshot.objects[object];
        Self {
            track_id: seen.track,
            label: seen.label.clone(),
            answer: seen.answer(),
            place: place.to_owned(),
            sentence: None,
            transport: None,
            frame_sequence: snapshot.sequence,
            source_name: snapshot.source_name.clone(),
            notes: Vec::new(),
            processing_ms: 0.0,
        }
    }

    /// Sets the plan.
    pub(super) fn set(
        &mut self,
        transport: &Transport,
        grasps: &GraspPlan,
        (frame, arm): (&PlanningFrame, &Arm),
    ) {
        let grasp = &grasps.grasps[transport.reached.grasp];
        self.transport = Some(TransportDocument {
            to_grasp: path(&transport.reached.path, arm),
            grasp: planned(grasp, frame),
            to_place: path(&transport.path, arm),
            placement: placement(&transport.placement, frame),
        });
    }
}

fn placement(placement: &PlacePose, frame: &PlanningFrame) -> PlacementDocument {
    let world = frame.world_from_plan;
    let pose = world * placement.plan_from_tool;
    let in_world = |place: Point3<f64>| -> [f64; 3] { (world * place).coords.into() };
    let up = Translation3::from(Vector3::z() * placement.way_m) * placement.plan_from_tool;
    let back = Point3::new(0.0, 0.0, -placement.way_m);
    PlacementDocument {
        foot_m: in_world(placement.foot),
        turn_deg: placement.turn_rad.to_degrees(),
        surface: placement.surface.clone(),
        position_m: pose.translation.vector.into(),
        orientation_xyzw: pose.rotation.coords.into(),
        above_position_m: in_world(up.translation.vector.into()),
        retreat_position_m: in_world(placement.plan_from_tool * back),
        opening_mm: 1e3 * placement.opening_m,
        above_rad: placement.above_rad.into(),
        release_rad: placement.release_rad.into(),
        retreat_rad: placement.retreat_rad.into(),
    }
}
