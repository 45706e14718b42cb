//! Driver of an arm: what every driver does, whatever its arm is.
//!
//! A driver implements [`Arm`]: begin a motion, brake, tell the state. [`ArmDuties`] does the rest
//! in each cycle of the driver's loop: it reads the stop word, watches the lease of the commander,
//! and answers requests. The simulator calls it from a loop of its own; a driver of a real arm
//! implements [`CyclicArm`], too, and is run by [`run`]. The example `arm_skeleton` is such a driver
//! for six motors that take velocities.
//!
//! This crate never plans a motion, and knows no joint limits: those are the arm's.

mod arm;
mod arm_duties;
mod arm_log;
mod arm_reading;
mod arm_requests;
mod commanded_pose;
mod driver_loop;

pub use arm::{Arm, BrakingCause, CyclicArm};
pub use arm_duties::ArmDuties;
pub use arm_log::ArmLog;
pub use arm_reading::ArmReading;
pub use arm_requests::{ArmRequest, ArmRequests, arm_requests};
pub use commanded_pose::commanded_pose;
pub use driver_loop::{CYCLE, FINAL_BRAKING, REQUESTS_PER_CYCLE, run};
