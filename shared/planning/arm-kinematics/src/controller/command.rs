//! Commands of the arm and their states.

use geometry::RigidTransform;

use crate::inverse_kinematics::check_pose;
use crate::{Arm, Error, JointVector};
use value_range::check_range;

/// Lowest speed of a command, as a share of the maximum joint velocities. Chosen.
const MIN_SPEED: f64 = 0.01;

/// Interpolation of a tool motion: joint space or Cartesian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathKind {
    /// Joint-space interpolation: the fastest motion of the joints.
    Joint,
    /// Cartesian interpolation: the tool moves on a straight line and rotates about one axis. For
    /// approach and lift.
    Linear,
}

/// Command to the arm. `speed` is the share of the maximum joint velocities, 0.01 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Moves the tool of the arm to a pose.
    MoveTo {
        /// Target pose of the tool, base frame.
        base_from_tool: RigidTransform,
        /// Interpolation of the tool motion.
        path: PathKind,
        /// Share of the maximum joint velocities, 0.01 to 1.
        speed: f64,
    },
    /// Moves the arm's joints to given angles.
    MoveJoints {
        /// Target joint angles, radians.
        joints_rad: JointVector,
        /// Share of the maximum joint velocities, 0.01 to 1.
        speed: f64,
    },
    /// Moves the pads to a given opening. When it is narrower than the current one, the fingers
    /// stop at an object that both pads touch.
    Open {
        /// Target distance between the pads, metres.
        opening_m: f64,
    },
    /// Closes until both pads touch an object or each other.
    Close,
    /// Emergency stop: all joints brake at once, and all commands are cancelled.
    Stop,
}

impl Command {
    /// Validates all numbers of the command.
    pub(crate) fn check(&self, arm: &Arm) -> Result<(), Error> {
        match self {
            Self::MoveTo {
                base_from_tool,
                speed,
                ..
            } => {
                check_pose(base_from_tool)?;
                check_speed(*speed)
            }
            Self::MoveJoints { joints_rad, speed } => {
                arm.chain().check(joints_rad)?;
                check_speed(*speed)
            }
            Self::Open { opening_m } => arm.gripper().check_opening(*opening_m),
            Self::Close | Self::Stop => Ok(()),
        }
    }
}

fn check_speed(speed: f64) -> Result<(), Error> {
    Ok(check_range(
        "the speed as a share of the greatest",
        speed,
        MIN_SPEED,
        1.0,
    )?)
}

/// State of an arm command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CommandState {
    /// Command waits in the queue.
    Accepted,
    /// Command is being executed.
    Running {
        /// Elapsed share of the motion's duration, 0 to 1.
        progress: f64,
    },
    /// Command completed successfully.
    Done,
    /// Command failed with this error.
    Failed(Error),
    /// Cancelled: stopped, replaced, or queued behind a command that failed.
    Stopped,
}

impl CommandState {
    /// True if the command can change its state no more.
    pub fn is_final(&self) -> bool {
        !matches!(self, Self::Accepted | Self::Running { .. })
    }
}
