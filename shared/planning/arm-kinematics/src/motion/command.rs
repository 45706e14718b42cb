//! What the arm can be told, and what became of it.

use geometry::RigidTransform;

use crate::error::check_range;
use crate::inverse_kinematics::check_pose;
use crate::{Arm, Error, JointVector};

/// Least share of the joints' greatest velocities.
const LEAST_SPEED: f64 = 0.01;

/// How the tool comes to a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Path {
    /// As fast as the joints can, on whatever curve this gives.
    Joint,
    /// On a straight line, turning evenly: for approach and lift.
    Straight,
}

/// What the arm is to do. `speed` is the share of the joints' greatest
/// velocities, 0.01 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Bring the tool to a pose.
    MoveTo {
        /// The tool's pose in the base frame.
        base_from_tool: RigidTransform,
        /// How.
        path: Path,
        /// How fast.
        speed: f64,
    },
    /// Bring the joints to angles.
    MoveJoints {
        /// The angles, radians.
        joints_rad: JointVector,
        /// How fast.
        speed: f64,
    },
    /// Bring the pads to a distance. Also narrower than they are, and then they
    /// stop at what they touch.
    Open {
        /// Distance between the pads, metres.
        opening_m: f64,
    },
    /// Close until both pads touch something or each other.
    Close,
    /// Stand still at once and forget all commands.
    Stop,
}

impl Command {
    /// Checks all numbers.
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
    check_range(
        "the speed as a share of the greatest",
        speed,
        LEAST_SPEED,
        1.0,
    )
}

/// What became of a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CommandState {
    /// It waits for those before it.
    Accepted,
    /// It is being carried out.
    Running {
        /// Share of the time it takes that has passed, 0 to 1.
        progress: f64,
    },
    /// It was carried out.
    Done,
    /// It can not be carried out; the error says why.
    Failed(Error),
    /// It was given up: stopped, replaced, or behind one that failed.
    Stopped,
}

impl CommandState {
    /// Whether nothing will change any more.
    pub fn is_final(&self) -> bool {
        !matches!(self, Self::Accepted | Self::Running { .. })
    }
}
