//! Reach of a grasp: inverse kinematics along the straight lines of approach and lift.

use crate::rejection::{GraspPhase, Rejection};
use crate::surroundings::Surroundings;
use arm_kinematics::{
    Arm, Error, IkConfig, JointVector, LineTrajectory, inverse_kinematics, link_capsules,
};
use geometry::RigidTransform;
use nalgebra::{Translation3, Vector3};

/// Share of the joints' speed at which the lines are planned; it changes no place on them.
const SPEED: f64 = 0.5;
/// Number of capsules at the end of the arm that the boxes of the hand stand for: the hand, the
/// rail and two fingers.
pub const N_HAND_CAPSULES: usize = 4;
/// Number of capsules at the beginning that stand beside the table: base and shoulder.
pub const N_BASE_CAPSULES: usize = 3;

/// Arm in the frame of planning.
#[derive(Debug, Clone)]
pub struct PlacedArm {
    /// Kinematic model.
    pub arm: Arm,
    /// Pose of the base.
    pub plan_from_base: RigidTransform,
    /// Present joint angles, radians.
    pub joints_rad: JointVector,
}

/// Joint angles of a grasp, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraspJoints {
    /// Begin of the approach.
    pub approach_rad: JointVector,
    /// Grasp.
    pub grasp_rad: JointVector,
    /// End of the lift.
    pub lift_rad: JointVector,
}

/// Ways of a grasp, metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GraspWays {
    pub(crate) approach_m: f64,
    pub(crate) lift_m: f64,
}

/// Finds joint angles with which the tool moves straight to a grasp and straight up from it.
pub(crate) fn reach(
    placed: &PlacedArm,
    plan_from_tool: &RigidTransform,
    ways: GraspWays,
    surroundings: &Surroundings<'_>,
) -> Result<GraspJoints, Rejection> {
    let arm = &placed.arm;
    let in_base = |pose: &RigidTransform| placed.plan_from_base.inv_mul(pose);
    let grasp = in_base(plan_from_tool);
    let begin = in_base(&(plan_from_tool * Translation3::new(0.0, 0.0, -ways.approach_m)));
    let up = Translation3::from(Vector3::z() * ways.lift_m);
    let end = in_base(&(up * plan_from_tool));
    let near = &placed.joints_rad;
    let configurations = arm.configurations(&begin, near);
    let mut reason = None;
    for start in configurations.map_err(Rejection::OutOfReach)? {
        match along_lines(arm, &start, &grasp, &end) {
            Ok(joints) => match blocked(placed, &joints, surroundings) {
                None => return Ok(joints),
                Some(rejection) => reason = Some(rejection),
            },
            Err(error) => reason = reason.or(Some(Rejection::OutOfReach(error))),
        }
    }
    Err(reason.unwrap_or_else(|| {
        let unreachable = inverse_kinematics(arm, &begin, near, &IkConfig::default());
        Rejection::OutOfReach(unreachable.err().unwrap_or(Error::LineLeavesWorkspace {
            reached_m: 0.0,
            length_m: ways.approach_m,
        }))
    }))
}

fn along_lines(
    arm: &Arm,
    start: &JointVector,
    grasp: &RigidTransform,
    end: &RigidTransform,
) -> Result<GraspJoints, Error> {
    let grasp_rad = LineTrajectory::plan(arm, start, grasp, SPEED)?.target_rad();
    let lift_rad = LineTrajectory::plan(arm, &grasp_rad, end, SPEED)?.target_rad();
    Ok(GraspJoints {
        approach_rad: *start,
        grasp_rad,
        lift_rad,
    })
}

/// Reason why the arm cannot stand at the ends of the ways; the hand is tested by its boxes.
fn blocked(
    placed: &PlacedArm,
    joints: &GraspJoints,
    surroundings: &Surroundings<'_>,
) -> Option<Rejection> {
    let opening_m = placed.arm.gripper().max_opening_m;
    let poses = [
        (joints.approach_rad, GraspPhase::Approach),
        (joints.grasp_rad, GraspPhase::Approach),
        (joints.lift_rad, GraspPhase::Lift),
    ];
    poses.iter().find_map(|(angles_rad, phase)| {
        if placed.arm.is_self_colliding(angles_rad) {
            return Some(Rejection::HitsItself);
        }
        let capsules = link_capsules(&placed.arm, angles_rad, opening_m);
        let links = &capsules[N_BASE_CAPSULES..capsules.len() - N_HAND_CAPSULES];
        let hit = links
            .iter()
            .map(|link| link.transformed(&placed.plan_from_base))
            .find_map(|link| surroundings.hit_by_link(&link));
        let phase = *phase;
        hit.map(|what| Rejection::Hits { what, phase })
    })
}
