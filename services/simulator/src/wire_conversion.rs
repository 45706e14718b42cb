//! Conversion between the simulation's types and wire messages.

use arm_driver::{ArmReading, commanded_pose};
use control_protocol::ArmMotion;
use message::{ArmActivity, Text, TrueObject as WireObject, TrueState, WireCapsule, WirePose};
use nalgebra::Isometry3;
use simulated_world::{ArmCommand, ArmStatus, MotionState, ObjectState, ObjectTruth};

/// Arm command of a motion on the wire.
///
/// # Errors
/// A sentence when its numbers are no pose.
pub(crate) fn command(motion: &ArmMotion) -> Result<ArmCommand, String> {
    Ok(match *motion {
        ArmMotion::MoveTo {
            position_m,
            orientation_xyzw,
            straight,
        } => ArmCommand::MoveTo {
            world_from_gripper: commanded_pose(position_m, orientation_xyzw)?,
            is_straight: straight,
        },
        ArmMotion::MoveJoints { angles_rad } => ArmCommand::MoveJoints(angles_rad),
        ArmMotion::Home => ArmCommand::Home,
        ArmMotion::Open => ArmCommand::Open,
        ArmMotion::OpenTo { opening_m } => ArmCommand::OpenTo(opening_m),
        ArmMotion::Close => ArmCommand::Close,
    })
}

fn activity(status: &ArmStatus) -> ArmActivity {
    if status.failure.is_some() {
        return ArmActivity::Failed;
    }
    match status.motion {
        MotionState::Idle => ArmActivity::Idle,
        MotionState::Moving => ArmActivity::Moving,
        MotionState::Opening => ArmActivity::Opening,
        MotionState::Closing => ArmActivity::Closing,
        MotionState::Stopped => ArmActivity::Stopped,
        MotionState::Failed(_) => ArmActivity::Failed,
    }
}

/// State of the arm for answers and messages.
pub(crate) fn reading(status: &ArmStatus) -> ArmReading {
    ArmReading {
        activity: activity(status),
        note: status.failure.clone().unwrap_or_default(),
        command_id: status.command_id,
        joint_angles_rad: status.joint_angles_rad,
        joint_velocities_rad_s: status.joint_velocities_rad_s,
        opening_m: status.opening_m,
        world_from_gripper: wire_pose(&status.world_from_gripper),
        is_holding: status.holds.is_some(),
    }
}

fn wire_pose(pose: &Isometry3<f64>) -> WirePose {
    WirePose {
        position_m: pose.translation.vector.into(),
        orientation_xyzw: pose.rotation.coords.into(),
    }
}

pub(crate) fn capsules(capsules: &[geometry::Capsule]) -> Vec<WireCapsule> {
    capsules.iter().map(WireCapsule::from).collect()
}

pub(crate) fn true_object(object: &ObjectTruth) -> WireObject {
    let state = match object.state {
        ObjectState::Settled => TrueState::Settled,
        ObjectState::Moving => TrueState::Moving,
        ObjectState::HeldByPerson => TrueState::HeldByPerson,
        ObjectState::HeldByArm => TrueState::HeldByArm,
        ObjectState::OnFloor => TrueState::OnFloor,
    };
    WireObject {
        id: object.id.into(),
        state: state.code(),
        world_from_object: wire_pose(&object.world_from_object),
        size_m: object.size_m.cast::<f32>().into(),
        visible_fraction: object.visible_fraction() as f32,
        visible_px: object.visible_px,
        unoccluded_px: object.unoccluded_px,
        category: Text::truncated(&object.category),
        name: Text::truncated(&object.name),
    }
}
