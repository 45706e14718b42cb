//! Kinematics and motion control of a six-joint robot arm with a parallel gripper.
//!
//! Six revolute joints and two parallel fingers, with the lengths and the stroke of a Kinova
//! JACO. Units are metres, radians and seconds; numbers are `f64`. The base frame stands on the
//! mounting plate: x forward, z up. The tool frame is between the finger pads: z forward (the
//! direction of approach), x along the closing direction of the fingers.
//!
//! ```
//! use arm_kinematics::{Arm, HOME, IkConfig, JointVector, inverse_kinematics};
//!
//! let arm = Arm::jaco_like();
//! let home = JointVector::from(HOME);
//! let mut target = arm.tool_pose(&home);
//! target.translation.z += 0.05;
//! let solution = inverse_kinematics(&arm, &target, &home, &IkConfig::default())?;
//! let reached = arm.tool_pose(&solution.joints_rad);
//! assert!((reached.translation.vector - target.translation.vector).norm() < 0.001);
//! # Ok::<(), arm_kinematics::Error>(())
//! ```
//!
//! Motion is kinematic, without masses, forces or contacts. The caller simulates contact and
//! passes it to [`ArmController::step`].
//!
//! Invariants: this crate never reads a clock, does no I/O and draws no random numbers. No input
//! makes it panic or produce a joint angle that is not finite or not within its limits.

mod arm;
mod closed_form;
mod controller;
mod damped_least_squares;
mod dimensions;
mod error;
mod gripper;
mod ik_config;
mod inverse_kinematics;
mod joint_trajectory;
mod kinematic_chain;
mod line_trajectory;
mod link_capsules;
mod link_meshes;
mod pose_residual;
mod self_clearance;
mod tapered_cylinder;
mod trapezoidal_profile;

pub use arm::{Arm, BodyPoses, HOME};
pub use controller::{ArmController, Command, CommandState, MotionState, PathKind};
pub use dimensions::ArmDimensions;
pub use error::Error;
pub use gripper::{FingerContact, Gripper, GripperModel, GripperMotion, tool_from_fingers};
pub use ik_config::IkConfig;
pub use inverse_kinematics::{IkSolution, inverse_kinematics};
pub use joint_trajectory::{JointState, JointTrajectory};
pub use kinematic_chain::{Jacobian, Joint, JointVector, KinematicChain, LinkPoses, N_JOINTS};
pub use line_trajectory::LineTrajectory;
pub use link_capsules::{N_CAPSULES, link_capsules};
pub use link_meshes::LinkMeshes;
pub use pose_residual::PoseResidual;
pub use self_clearance::self_clearance_m;

/// Proptest strategy: joint angles of the JACO-like arm, uniform within its limits.
#[cfg(test)]
fn test_joint_angles() -> impl proptest::strategy::Strategy<Value = JointVector> {
    use proptest::strategy::Strategy;
    proptest::array::uniform6(0.0..=1.0_f64).prop_map(|shares| {
        let arm = Arm::jaco_like();
        JointVector::from_fn(|i, _| {
            let joint = &arm.chain().joints[i];
            joint.min_rad + shares[i] * (joint.max_rad - joint.min_rad)
        })
    })
}
