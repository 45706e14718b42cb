//! Scene of the arm: a snapshot of the daemon with the arm, people, stored models and the gripper,
//! and the plans of grasps and transports in it.
//!
//! [`ArmAndPeople`] receives the bodies beside the objects, an [`ArmScene`] joins them with a
//! snapshot. Programs that plan the arm's motions share it, so that what is shown is what is done.

mod arm_and_people;
mod arm_scene;

pub use arm_and_people::ArmAndPeople;
pub use arm_scene::{ArmScene, SEED};
