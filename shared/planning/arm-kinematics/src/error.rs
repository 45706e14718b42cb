//! Why the arm does not do what it is asked.

use std::fmt;

/// Why a pose, a command or a number was refused. Lengths are metres, angles radians.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite, or a quaternion is not of unit length.
    BadNumber {
        /// What carries the number.
        what: &'static str,
        /// What it must be.
        rule: &'static str,
    },
    /// A number lies outside its range.
    OutOfRange {
        /// What carries the number, with its unit.
        what: &'static str,
        /// The number.
        value: f64,
        /// Least allowed value.
        min: f64,
        /// Greatest allowed value.
        max: f64,
    },
    /// A joint angle lies outside the joint's limits.
    JointLimit {
        /// The joint, counted from 1 at the base.
        joint: usize,
        /// The angle.
        angle_rad: f64,
        /// Least angle of the joint.
        min_rad: f64,
        /// Greatest angle of the joint.
        max_rad: f64,
    },
    /// No joint angles bring the tool to the pose.
    Unreachable {
        /// How far from the pose the nearest found position stays.
        distance_m: f64,
        /// How far it stays turned away from the pose.
        angle_rad: f64,
        /// Steps of descent that were spent.
        n_iterations: usize,
    },
    /// A straight line leaves what the arm can reach.
    LineLeavesWorkspace {
        /// Length of the line that can be followed.
        reached_m: f64,
        /// Length of the whole line.
        length_m: f64,
    },
    /// A straight line can only be followed with a sudden change of the joints.
    LineJumps {
        /// Length of the line that can be followed.
        reached_m: f64,
        /// Length of the whole line.
        length_m: f64,
        /// The joint that would jump, counted from 1 at the base.
        joint: usize,
    },
    /// Too many commands wait.
    QueueFull {
        /// How many commands may wait.
        capacity: usize,
    },
    /// A command with this identity is known already.
    RepeatedId {
        /// The identity.
        id: u64,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BadNumber { what, rule } => {
                write!(
                    f,
                    "{what} can not be used: {rule}; check where it was computed"
                )
            }
            Self::OutOfRange {
                what,
                value,
                min,
                max,
            } => {
                write!(f, "{what} is {value} but must lie between {min} and {max}")
            }
            Self::JointLimit {
                joint,
                angle_rad,
                min_rad,
                max_rad,
            } => write!(
                f,
                "joint {joint} can not turn to {}; give it an angle between {} and {}",
                Degrees(angle_rad),
                Degrees(min_rad),
                Degrees(max_rad)
            ),
            Self::Unreachable {
                distance_m,
                angle_rad,
                ..
            } => fmt_out_of_reach(f, distance_m, angle_rad),
            Self::LineLeavesWorkspace {
                reached_m,
                length_m,
            } => fmt_line(f, "leaves the arm's reach", reached_m, length_m),
            Self::LineJumps {
                reached_m,
                length_m,
                joint,
            } => fmt_line(f, &format!("makes joint {joint} jump"), reached_m, length_m),
            Self::QueueFull { capacity } => {
                write!(
                    f,
                    "{capacity} commands wait already; send the next when one is done"
                )
            }
            Self::RepeatedId { id } => {
                write!(
                    f,
                    "a command with the id {id} is known already; give each its own"
                )
            }
        }
    }
}

fn fmt_out_of_reach(f: &mut fmt::Formatter<'_>, distance_m: f64, angle_rad: f64) -> fmt::Result {
    write!(
        f,
        "the pose is out of the arm's reach: the tool stays {:.0} mm and {} away from it; choose \
         a pose nearer to the arm or another direction of approach",
        1000.0 * distance_m,
        Degrees(angle_rad)
    )
}

fn fmt_line(f: &mut fmt::Formatter<'_>, what: &str, reached_m: f64, length_m: f64) -> fmt::Result {
    write!(
        f,
        "the straight line {what} after {:.0} of {:.0} mm; move through the joints or from \
         another side",
        1000.0 * reached_m,
        1000.0 * length_m
    )
}

/// An angle as people read it.
struct Degrees(f64);

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1}°", self.0.to_degrees())
    }
}

impl std::error::Error for Error {}

/// Checks that a number lies in its range; NaN lies in none.
pub(crate) fn check_range(what: &'static str, value: f64, min: f64, max: f64) -> Result<(), Error> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(Error::OutOfRange {
            what,
            value,
            min,
            max,
        })
    }
}
