//! Errors of kinematics, planning and commands.

use std::fmt;
use value_range::OutOfRange;

/// Rejected pose, command or number. Lengths are in metres, angles in radians.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite, or a quaternion is not of unit length.
    #[error("{what} cannot be used: {rule}; check where it was computed")]
    BadNumber {
        /// Name of the quantity that contains the invalid number.
        what: &'static str,
        /// Rule that the number violates.
        rule: &'static str,
    },
    /// Number outside its valid range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// Joint angle outside the joint's limits.
    #[error(
        "joint {joint} cannot turn to {}; give it an angle between {} and {}",
        Degrees(*angle_rad),
        Degrees(*min_rad),
        Degrees(*max_rad)
    )]
    JointLimit {
        /// Number of the joint, counted from 1 at the base.
        joint: usize,
        /// Joint angle outside its limits, radians.
        angle_rad: f64,
        /// Lower limit of the joint, radians.
        min_rad: f64,
        /// Upper limit of the joint, radians.
        max_rad: f64,
    },
    /// Inverse kinematics has no solution for the pose.
    #[error(
        "the pose is out of the arm's reach: the tool stays {:.0} mm and {} away from it; choose \
         a pose nearer to the arm or another direction of approach",
        1000.0 * distance_m,
        Degrees(*angle_rad)
    )]
    Unreachable {
        /// Distance from the requested tool position to the nearest reachable one, metres.
        distance_m: f64,
        /// Rotation angle from the requested tool orientation to that of the nearest
        /// reachable pose, radians.
        angle_rad: f64,
        /// Number of solver iterations spent.
        n_iterations: usize,
    },
    /// Straight line that leaves the workspace of the arm.
    #[error(
        "the straight line leaves the arm's reach after {:.0} of {:.0} mm; move through the joints \
         or from another side",
        1000.0 * reached_m,
        1000.0 * length_m
    )]
    LineLeavesWorkspace {
        /// Length of the reachable part of the line, metres.
        reached_m: f64,
        /// Length of the whole line, metres.
        length_m: f64,
    },
    /// Straight line that needs a sudden change of a joint (singularity).
    #[error(
        "the straight line makes joint {joint} jump after {:.0} of {:.0} mm; move through the \
         joints or from another side",
        1000.0 * reached_m,
        1000.0 * length_m
    )]
    LineJumps {
        /// Length of the line up to the joint jump, metres.
        reached_m: f64,
        /// Length of the whole line, metres.
        length_m: f64,
        /// Number of the joint that would jump, counted from 1 at the base.
        joint: usize,
    },
    /// The command queue is full.
    #[error("{capacity} commands wait already; send the next when one is done")]
    QueueFull {
        /// Capacity of the command queue.
        capacity: usize,
    },
    /// Repeated identity of an existing command.
    #[error("a command with the id {id} is known already; give each its own")]
    RepeatedId {
        /// Repeated command identity.
        id: u64,
    },
}

/// Angle in radians that is displayed in degrees.
struct Degrees(f64);

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1}°", self.0.to_degrees())
    }
}
