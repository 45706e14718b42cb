//! The arm: kinematic chain, inverse kinematics, joint motion, gripper.
//!
//! Six revolute joints and two parallel fingers, in the lengths and the stroke
//! of a Kinova JACO. Units are metres, radians and seconds; numbers are `f64`.
//! The base frame stands on the mounting plate: x forward, z up. The tool frame
//! lies between the finger pads: z forward (the direction of approach), x along
//! the direction in which the fingers close.
//!
//! Motion is kinematic: there are no masses, forces or contacts here. Whoever
//! simulates contact tells [`ArmMotion::step`] that the pads touch something.
//!
//! Invariants: this crate never reads a clock, never does I/O, draws no random
//! numbers, and no input makes it panic or produce a joint angle that is not
//! finite or not within its limits.

mod arm;
mod closed_form;
mod damped_least_squares;
mod dimensions;
mod error;
mod gripper;
mod inverse_kinematics;
mod joint_trajectory;
mod kinematic_chain;
mod limb;
mod line_trajectory;
mod link_capsules;
mod link_meshes;
mod motion;
mod self_clearance;
mod velocity_profile;

pub use arm::{Arm, BodyPoses, HOME};
pub use dimensions::ArmDimensions;
pub use error::Error;
pub use gripper::{Gripper, GripperGeometry, GripperMotion, tool_from_fingers};
pub use inverse_kinematics::{IkConfig, IkSolution, PoseResidual, inverse_kinematics};
pub use joint_trajectory::{JointState, JointTrajectory};
pub use kinematic_chain::{Jacobian, Joint, JointVector, KinematicChain, LinkPoses, N_JOINTS};
pub use line_trajectory::LineTrajectory;
pub use link_capsules::{N_CAPSULES, link_capsules};
pub use link_meshes::LinkMeshes;
pub use motion::{ArmMotion, Command, CommandState, MotionState, Path};
pub use self_clearance::self_clearance_m;

/// Joint angles of the JACO-like arm, anywhere within its limits.
#[cfg(test)]
fn test_angles() -> impl proptest::strategy::Strategy<Value = JointVector> {
    use proptest::strategy::Strategy;
    proptest::array::uniform6(0.0..=1.0_f64).prop_map(|shares| {
        let arm = Arm::jaco_like();
        JointVector::from_fn(|i, _| {
            let joint = &arm.chain().joints[i];
            joint.min_rad + shares[i] * (joint.max_rad - joint.min_rad)
        })
    })
}
