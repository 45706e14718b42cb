//! Motions of the simulated arm, one after the other.

use arm_kinematics::{Arm, JointVector};
use grasp_scene::placed_arm;
use grasping::PlacedArm;
use scene_client::PlanningFrame;
use simulated_world::{ArmCommand, ArmStatus, MotionState, STEPS_PER_SECOND, World};

/// Longest time of a motion of the arm, seconds of the simulation.
const MOTION_MAX_S: u32 = 30;

/// Arm of the world in a frame of planning.
pub(super) fn arm_of(world: &World, frame: &PlanningFrame) -> Option<PlacedArm> {
    let status = world.arm_status()?;
    let joints_rad = JointVector::from(status.joint_angles_rad);
    let gripper = &status.world_from_gripper;
    Some(placed_arm(Arm::jaco_like(), joints_rad, gripper, frame))
}

/// Gives the arm a command, and steps the world until it is done.
pub(super) fn command(world: &mut World, command: &ArmCommand) -> Result<ArmStatus, String> {
    world.command_arm(command)?;
    for _ in 0..MOTION_MAX_S * STEPS_PER_SECOND {
        world.step();
        let Some(status) = world.arm_status() else {
            break;
        };
        if let Some(failure) = status.failure {
            return Err(failure);
        }
        if !matches!(
            status.motion,
            MotionState::Moving | MotionState::Opening | MotionState::Closing
        ) {
            return Ok(status);
        }
    }
    Err("the motion did not end".to_owned())
}
