//! The robot as a client of the daemon sees it: its requests, its arm, and what the camera shows.

mod arm_driver;
mod scene_watch;

pub(crate) use arm_driver::{ArmDriver, MotionProgress};
pub(crate) use scene_watch::SceneWatch;
