//! Commands to the arm and what it says of itself.

use crate::ARM_JOINTS;
use serde::{Deserialize, Serialize};

/// What an arm can be told. Poses are those of the gripper: the point between the
/// finger tips, z forward along the fingers, x the direction in which they close.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmCommand {
    /// Say how the arm is.
    State,
    /// Move the gripper to a pose, on a straight line or as is quickest for the joints.
    MoveTo {
        /// Position, world frame, metres.
        position_m: [f64; 3],
        /// Orientation x, y, z, w.
        orientation_xyzw: [f64; 4],
        /// Whether the gripper is to follow a straight line.
        straight: bool,
    },
    /// Move the joints.
    MoveJoints {
        /// Angles from the base outwards, radians.
        angles_rad: [f64; ARM_JOINTS],
    },
    /// Move to the folded pose out of the camera's view.
    Home,
    /// Open the fingers; what they hold is let go.
    Open,
    /// Close the fingers until they hold something or meet.
    Close,
    /// Stop at once; what was still to be done is forgotten.
    Stop,
}

/// How the arm is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArmReport {
    /// The command this answers, or the last one; 0 before the first.
    pub command_id: u64,
    /// idle, moving, opening, closing, stopped or failed.
    pub activity: String,
    /// Why the last command failed, empty otherwise.
    pub note: String,
    /// Angles from the base outwards, radians.
    pub joint_angles_rad: [f64; ARM_JOINTS],
    /// Distance between the fingers, metres.
    pub opening_m: f64,
    /// Position of the gripper, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Whether the fingers hold something.
    pub is_holding: bool,
}
