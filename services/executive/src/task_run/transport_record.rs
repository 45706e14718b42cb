//! Record of a planned transport: grasp, ways and placement in the world, as the working memory keeps
//! it and the arm carries it out.

use arm_scene::ArmScene;
use control_protocol::ArmMotion;
use geometry::{OrientedBox, RigidTransform};
use grasping::{Grasp, GraspScene, contact_surface};
use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use tasks::TaskPhase;
use transport::{CarriedLoad, PlacePose, TransitPath, Transport};

/// Distance and turn within which two grasps are one: those of plans from two views of an object that
/// stands still. Chosen.
const SAME_GRASP_M: f64 = 0.015;
const SAME_GRASP_RAD: f64 = 0.26;

/// Pose of the tool, world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct ToolPose {
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
}

/// Box by its pose and half sides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct BoxRecord {
    pose: ToolPose,
    half_sides_m: [f64; 3],
}

/// Transport of one object, world, metres and radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct TransportRecord {
    /// Distance between the pads before the grasp.
    opening_m: f64,
    /// Joint angles of the way to the begin of the approach.
    to_grasp_rad: Vec<[f64; 6]>,
    approach: ToolPose,
    grasp: ToolPose,
    lifted: ToolPose,
    /// Joint angles of the way from the end of the lift to over the place.
    to_place_rad: Vec<[f64; 6]>,
    /// Joint angles at the end of the lift.
    lift_rad: [f64; 6],
    /// Joint angles over the place.
    pub(super) above_rad: [f64; 6],
    release: ToolPose,
    /// Distance between the pads after the release.
    release_opening_m: f64,
    retreat: ToolPose,
    /// Middle of the object's foot at its place.
    foot_m: [f64; 3],
    /// Distance between the pads while they hold the object.
    pub(super) width_m: f64,
    /// Box around the object, tool.
    load: Option<BoxRecord>,
    /// True if the object goes back to where it was lifted.
    pub(super) is_set_back: bool,
}

impl ToolPose {
    fn of(pose: &RigidTransform) -> Self {
        Self {
            position_m: pose.translation.vector.into(),
            orientation_xyzw: pose.rotation.coords.into(),
        }
    }

    fn pose(&self) -> RigidTransform {
        let [x, y, z, w] = self.orientation_xyzw;
        RigidTransform::from_parts(
            Translation3::from(self.position_m),
            UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
        )
    }

    fn motion(&self) -> ArmMotion {
        ArmMotion::MoveTo {
            position_m: self.position_m,
            orientation_xyzw: self.orientation_xyzw,
            straight: true,
        }
    }
}

impl TransportRecord {
    /// Record of a transport of an object in a scene by a grasp.
    pub(super) fn new(
        (arm_scene, scene): (&ArmScene, &GraspScene<'_>),
        object: usize,
        grasp: &Grasp,
        transport: &Transport,
    ) -> Self {
        let world = arm_scene.frame.world_from_plan;
        let contacts = contact_surface(scene, object);
        let load = CarriedLoad::of(&contacts, &grasp.plan_from_tool, None);
        let tool = |plan_from_tool: RigidTransform| ToolPose::of(&(world * plan_from_tool));
        let back = |pose: &RigidTransform, way_m: f64| pose * Translation3::new(0.0, 0.0, -way_m);
        let up = Translation3::from(Vector3::z() * grasp.lift_m);
        let PlacePose {
            plan_from_tool,
            foot,
            way_m,
            opening_m,
            above_rad,
            ..
        } = &transport.placement;
        Self {
            opening_m: grasp.opening_m,
            to_grasp_rad: angles(&transport.reached.path),
            approach: tool(back(&grasp.plan_from_tool, grasp.approach_m)),
            grasp: tool(grasp.plan_from_tool),
            lifted: tool(up * grasp.plan_from_tool),
            to_place_rad: angles(&transport.path),
            lift_rad: grasp
                .joints
                .map_or(*above_rad, |joints| joints.lift_rad)
                .into(),
            above_rad: (*above_rad).into(),
            release: tool(*plan_from_tool),
            release_opening_m: *opening_m,
            retreat: tool(back(plan_from_tool, *way_m)),
            foot_m: (world * foot).coords.into(),
            width_m: grasp.width_m,
            load: load.map(|load| BoxRecord {
                pose: ToolPose::of(&load.body_in_tool.frame_from_box),
                half_sides_m: load.body_in_tool.half_sides_m.into(),
            }),
            is_set_back: false,
        }
    }

    /// Motions of a phase; none where it has no motions of its own.
    pub(super) fn motions(&self, phase: TaskPhase) -> Vec<ArmMotion> {
        let open_to = |opening_m: f64| ArmMotion::OpenTo { opening_m };
        match phase {
            TaskPhase::Reach => {
                let mut motions = vec![open_to(self.opening_m)];
                motions.extend(along(&self.to_grasp_rad));
                motions
            }
            TaskPhase::Approach | TaskPhase::SetBack => vec![self.grasp.motion()],
            TaskPhase::Close => vec![ArmMotion::Close],
            TaskPhase::Lift => vec![self.lifted.motion()],
            TaskPhase::Carry => along(&self.to_place_rad),
            TaskPhase::Lower => vec![self.release.motion()],
            TaskPhase::Release => vec![open_to(self.release_opening_m)],
            TaskPhase::Retreat => vec![self.retreat.motion()],
            TaskPhase::LetGo => vec![open_to(self.opening_m), self.approach.motion()],
            TaskPhase::Look
            | TaskPhase::Choose
            | TaskPhase::Ask
            | TaskPhase::Plan
            | TaskPhase::CheckLift
            | TaskPhase::Replan
            | TaskPhase::Leave
            | TaskPhase::CheckPlace
            | TaskPhase::Return
            | TaskPhase::Halt
            | TaskPhase::Succeeded
            | TaskPhase::Failed
            | TaskPhase::Cancelled => Vec::new(),
        }
    }

    /// Replaces the way to the place by one from where the arm is.
    pub(super) fn go_by(&mut self, path: &TransitPath) {
        self.to_place_rad = angles(path);
    }

    /// Makes the place from which the object was lifted its goal.
    pub(super) fn set_back(&mut self) {
        self.above_rad = self.lift_rad;
        self.release = self.grasp;
        self.release_opening_m = self.opening_m;
        self.retreat = self.approach;
        self.is_set_back = true;
    }

    /// True if a pose of the tool is that of the grasp, as near as two plans of one grasp are.
    pub(super) fn is_grasp_near(&self, world_from_tool: &RigidTransform) -> bool {
        let own = self.grasp.pose();
        let offset_m = (own.translation.vector - world_from_tool.translation.vector).norm();
        offset_m <= SAME_GRASP_M
            && own.rotation.angle_to(&world_from_tool.rotation) <= SAME_GRASP_RAD
    }

    /// Middle of the object's foot at its place.
    pub(super) fn foot(&self) -> Point3<f64> {
        self.foot_m.into()
    }

    /// Load in the hand, with its index in a scene that shows it.
    pub(super) fn load(&self, object: Option<usize>) -> Option<CarriedLoad> {
        let load = self.load?;
        Some(CarriedLoad {
            body_in_tool: OrientedBox {
                frame_from_box: load.pose.pose(),
                half_sides_m: load.half_sides_m.into(),
            },
            object,
        })
    }

    /// Height of a place of the tool over that of the release, and its distance from it seen from
    /// above, metres.
    pub(super) fn over_release_m(&self, position_m: [f64; 3]) -> [f64; 2] {
        let offset = Vector3::from(position_m) - Vector3::from(self.release.position_m);
        [offset.z, offset.xy().norm()]
    }
}

/// Joint angles of a path.
pub(super) fn angles(path: &TransitPath) -> Vec<[f64; 6]> {
    let waypoints = path.waypoints_rad.iter();
    waypoints.map(|joints| (*joints).into()).collect()
}

/// Motions along a way, from its second configuration on.
pub(super) fn along(way_rad: &[[f64; 6]]) -> Vec<ArmMotion> {
    let further = way_rad.iter().skip(1);
    let motions = further.map(|angles_rad| ArmMotion::MoveJoints {
        angles_rad: *angles_rad,
    });
    motions.collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Record of a transport along one line.
    pub(in crate::task_run) fn record() -> TransportRecord {
        let pose = |z_m: f64| ToolPose::of(&RigidTransform::translation(0.3, 0.0, z_m));
        TransportRecord {
            opening_m: 0.1,
            to_grasp_rad: vec![[0.0; 6], [0.1; 6], [0.2; 6]],
            approach: pose(0.3),
            grasp: pose(0.1),
            lifted: pose(0.25),
            to_place_rad: vec![[0.2; 6], [0.4; 6]],
            lift_rad: [0.2; 6],
            above_rad: [0.4; 6],
            release: pose(0.12),
            release_opening_m: 0.08,
            retreat: pose(0.2),
            foot_m: [0.3, 0.0, 0.0],
            width_m: 0.06,
            load: None,
            is_set_back: false,
        }
    }

    #[test]
    fn record_survives_its_text() {
        let text = serde_json::to_string(&record()).unwrap();
        assert_eq!(
            serde_json::from_str::<TransportRecord>(&text).unwrap(),
            record()
        );
    }

    #[test]
    fn object_that_is_set_back_goes_to_where_it_was_lifted() {
        let mut record = record();
        record.set_back();
        assert_eq!(record.above_rad, [0.2; 6]);
        let down = record.motions(TaskPhase::Lower);
        assert_eq!(down, record.motions(TaskPhase::SetBack));
        let pose = |z_m: f64| RigidTransform::translation(0.3, 0.0, z_m);
        assert!(record.is_grasp_near(&pose(0.105)) && !record.is_grasp_near(&pose(0.13)));
    }

    #[test]
    fn motion_phases_have_motions_but_the_way_home() {
        for phase in TaskPhase::ALL.iter().filter(|phase| phase.is_motion()) {
            let is_way_home = matches!(phase, TaskPhase::Leave | TaskPhase::Return);
            assert_eq!(
                record().motions(*phase).is_empty(),
                is_way_home,
                "{phase:?}"
            );
        }
        assert_eq!(record().motions(TaskPhase::Reach).len(), 3);
    }
}
