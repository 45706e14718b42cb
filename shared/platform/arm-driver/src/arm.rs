//! Arm as its driver moves it: motion, braking, state.

use crate::ArmReading;
use control_protocol::ArmMotion;
use message::WireCapsule;
use service::monotonic_ns;

/// Cause of a braking.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BrakingCause {
    /// Stop word, or a stop word that was lost.
    Stop,
    /// Silence of the commander.
    Silence,
    /// Release of the lease by its commander.
    Release,
}

/// Arm that carries out motions and brakes. No call may wait: other duties have their turn in the
/// same cycle.
pub trait Arm {
    /// Begins a motion in place of the present one, from the present velocities. `arrived_ns` is the
    /// time at which it was commanded, monotonic, nanoseconds.
    ///
    /// # Errors
    /// The sentence with which the arm refuses it; the present motion goes on then.
    fn begin(&mut self, motion: &ArmMotion, arrived_ns: u64) -> Result<(), String>;

    /// Brakes all joints as hard as they may, lets the fingers stand, and ends the present motion.
    /// An arm at rest stays there, and is stopped.
    fn brake(&mut self, cause: BrakingCause);

    /// Present state of the arm.
    ///
    /// # Errors
    /// A sentence when there is no arm, or its state is not known.
    fn reading(&self) -> Result<ArmReading, String>;

    /// Present time for the lease, nanoseconds: monotonic, but for a simulation whose time is its
    /// own.
    fn lease_clock_ns(&self) -> u64 {
        monotonic_ns()
    }
}

/// Arm with a control cycle, which the loop of its driver calls.
pub trait CyclicArm: Arm {
    /// Measures the arm, and gives its motors their next set points, at `now_ns`, monotonic,
    /// nanoseconds.
    ///
    /// # Errors
    /// A sentence when the arm cannot be moved any more: its driver ends, and is started again.
    fn cycle(&mut self, now_ns: u64) -> Result<(), String>;

    /// Capsules that hold all links, the gripper and what it holds, world frame.
    fn capsules(&self) -> Vec<WireCapsule>;
}
