//! Way home: the arm moves out of the camera's sight past everything that is seen.

use super::transport_record::{along, angles};
use arm_kinematics::{HOME, JointVector};
use arm_scene::{ArmScene, SEED};
use control_protocol::{ArmMotion, ArmReport};
use grasping::Obstacles;
use transport::{CarriedLoad, TransitPath, TransitPlanner, reach_region};

/// Greatest joint angle from home at which the arm is there, radians.
const AT_HOME_RAD: f64 = 0.02;
/// Margin around a held object in which everything that is seen is the object itself, metres. Chosen:
/// it has turned between the fingers.
const HELD_MARGIN_M: f64 = 0.04;
/// Length of a straight way up that may free the hand, metres.
const UP_M: f64 = 0.1;

/// True if the arm stands at home.
pub(super) fn is_at_home(report: &ArmReport) -> bool {
    let pairs = report.joint_angles_rad.iter().zip(HOME);
    pairs
        .into_iter()
        .all(|(is, home)| (is - home).abs() <= AT_HOME_RAD)
}

/// Motions of the empty hand from where the arm is to home.
///
/// # Errors
/// The reason why there is no way, in words.
pub(super) fn way_home(arm_scene: &ArmScene, report: &ArmReport) -> Result<Vec<ArmMotion>, String> {
    let path = transit(
        arm_scene,
        &JointVector::from(HOME),
        (report.opening_m, None),
    );
    path.map(|path| along(&angles(&path)))
}

/// Path from where the arm is to joint angles, with the opening of the fingers and what they hold.
///
/// # Errors
/// The reason why there is none, in words.
pub(super) fn transit(
    arm_scene: &ArmScene,
    goal: &JointVector,
    (opening_m, load): (f64, Option<&CarriedLoad>),
) -> Result<TransitPath, String> {
    let placed = arm_scene
        .arm
        .as_ref()
        .ok_or("no arm is there, or the pose of the camera is unknown")?;
    let scene = arm_scene.scene();
    let region = reach_region(placed);
    let plan_from_tool = placed.plan_from_base * placed.arm.tool_pose(&placed.joints_rad);
    let held = load.map(|load| load.body_in_tool.transformed(&plan_from_tool));
    let obstacles = match &held {
        Some(body) => Obstacles::beside(&scene, &region, (body, HELD_MARGIN_M)),
        None => Obstacles::within(&scene, &region),
    };
    let planner = TransitPlanner {
        scene: &scene,
        obstacles: &obstacles,
        placed,
        opening_m,
        load,
        seed: SEED,
    };
    let path = planner.plan(&placed.joints_rad, goal);
    path.map_err(|reason| reason.words(&scene))
}

/// Straight way up from where the arm is.
pub(super) fn way_up(report: &ArmReport) -> Vec<ArmMotion> {
    let [x, y, z] = report.position_m;
    vec![ArmMotion::MoveTo {
        position_m: [x, y, z + UP_M],
        orientation_xyzw: report.orientation_xyzw,
        straight: true,
    }]
}
