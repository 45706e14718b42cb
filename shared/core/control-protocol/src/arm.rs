//! Arm commands, leases and state reports.

use scene_document::ARM_JOINTS;
use serde::{Deserialize, Serialize};

/// Command to the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmCommand {
    /// Report the state of the arm.
    State,
    /// Begin or renew a lease of the arm.
    Hold(ArmLease),
    /// End a lease of the arm.
    Release {
        /// Number of the lease.
        lease: u64,
    },
    /// Begin or renew a lease, and carry out a motion in place of the present one.
    Move {
        /// Lease of the commander.
        lease: ArmLease,
        /// Motion to carry out.
        motion: ArmMotion,
    },
    /// Stop the arm immediately, and end the lease of its commander.
    Stop,
}

/// Lease of the arm: its one commander renews it at least every half second, else the arm brakes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArmLease {
    /// Random number of the lease; one that has ended never begins again.
    pub id: u64,
    /// Name of the commander, which those who are refused get to read.
    pub holder: String,
}

/// Motion of the arm. Poses are those of the gripper: origin between the finger tips, z
/// forward along the fingers, x along the closing direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmMotion {
    /// Move the gripper to a pose, on a straight line or by the fastest joint motion.
    MoveTo {
        /// Target position of the gripper, world frame, metres.
        position_m: [f64; 3],
        /// Orientation of the gripper, quaternion: x, y, z, w.
        orientation_xyzw: [f64; 4],
        /// True for a straight line of the gripper; false for the fastest joint motion.
        straight: bool,
    },
    /// Move the joints of the arm.
    MoveJoints {
        /// Joint angles from the base outwards, radians.
        angles_rad: [f64; ARM_JOINTS],
    },
    /// Move to the folded home pose outside the camera's view.
    Home,
    /// Open the fingers and release any held object.
    Open,
    /// Move the fingers to an opening, and release any held object.
    OpenTo {
        /// Distance between the finger pads, metres.
        opening_m: f64,
    },
    /// Close the fingers until they grip an object or meet.
    Close,
}

/// State report of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArmReport {
    /// Id of the answered command, or of the last one; 0 before the first.
    pub command_id: u64,
    /// Activity: `idle`, `moving`, `opening`, `closing`, `stopped` or `failed`.
    pub activity: String,
    /// Reason for the failure of the last command; empty otherwise.
    pub note: String,
    /// Joint angles from the base outwards, radians.
    pub joint_angles_rad: [f64; ARM_JOINTS],
    /// Gripper opening: distance between the fingers, metres.
    pub opening_m: f64,
    /// Position of the gripper, world frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the gripper, world frame, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// True if the fingers hold an object.
    pub is_holding: bool,
    /// Name of the commander that holds the lease of the arm.
    #[serde(default)]
    pub commander: Option<String>,
}
