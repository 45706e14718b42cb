//! Measured state of an arm, as an answer and as a message of `arm/state`.

use control_protocol::ArmReport;
use message::{ArmActivity, ArmState, Text, WirePose};
use scene_document::ARM_JOINTS;

/// Speed below which a joint is at rest, rad/s.
const REST_SPEED_RAD_S: f64 = 0.01;

/// State of an arm at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmReading {
    /// Activity of the arm.
    pub activity: ArmActivity,
    /// Reason for the failure of the last command; empty otherwise.
    pub note: String,
    /// Id of the last command that was accepted; 0 before the first.
    pub command_id: u64,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: [f64; ARM_JOINTS],
    /// Joint velocities, radians per second.
    pub joint_velocities_rad_s: [f64; ARM_JOINTS],
    /// Gripper opening: distance between the fingers, metres.
    pub opening_m: f64,
    /// Pose of the gripper: origin between the finger tips, z forward, x along the closing
    /// direction.
    pub world_from_gripper: WirePose,
    /// True if the fingers hold an object.
    pub is_holding: bool,
}

impl ArmReading {
    /// True while the arm or its fingers move for a command.
    pub fn is_busy(&self) -> bool {
        matches!(
            self.activity,
            ArmActivity::Moving | ArmActivity::Opening | ArmActivity::Closing
        )
    }

    /// True if all joints are at rest.
    pub fn is_at_rest(&self) -> bool {
        let speeds = self.joint_velocities_rad_s;
        speeds.iter().all(|speed| speed.abs() < REST_SPEED_RAD_S)
    }

    /// State as an answer to a request.
    pub fn report(&self, commander: Option<&str>) -> ArmReport {
        ArmReport {
            command_id: self.command_id,
            activity: self.activity.word().into(),
            note: self.note.clone(),
            joint_angles_rad: self.joint_angles_rad,
            opening_m: self.opening_m,
            position_m: self.world_from_gripper.position_m,
            orientation_xyzw: self.world_from_gripper.orientation_xyzw,
            is_holding: self.is_holding,
            commander: commander.map(str::to_owned),
        }
    }

    /// State as a message of the topic, at `stamp_ns`, monotonic, nanoseconds.
    pub fn message(&self, stamp_ns: u64) -> ArmState {
        ArmState {
            activity: self.activity.code(),
            stamp_ns,
            joint_angles_rad: self.joint_angles_rad,
            joint_velocities_rad_s: self.joint_velocities_rad_s,
            opening_m: self.opening_m,
            world_from_gripper: self.world_from_gripper,
            command_id: self.command_id,
            is_holding: u32::from(self.is_holding),
            note: Text::truncated(&self.note),
            ..ArmState::default()
        }
    }
}
