//! Transport of objects by the arm: transit past obstacles, and placing.
//!
//! A [`TransitPlanner`] moves the arm, with or without an object in its hand, over a safe height
//! where that is free, else by RRT-Connect in joint space (Kuffner and LaValle 2000). A
//! [`PlacingPlanner`] finds poses in a [`PlaceArea`] where the object stands as it stood, clear of
//! its neighbours, with straight ways down and back. A [`TransportPlanner`] joins both with the
//! grasps of [`grasping`].
//!
//! Frames and units are those of [`grasping`]: z against gravity, metres, radians.
//!
//! Invariants: this crate does no I/O and reads no clock; random numbers come from a seed. A plan
//! depends on its arguments alone.

mod arm_collision;
mod carried_load;
mod place_area;
mod place_candidates;
mod place_plan;
mod place_rejection;
mod placing;
mod rrt_connect;
mod safe_height;
mod shortcut;
mod transit;
mod transport_planner;

pub use arm_collision::ArmObstacle;
pub use carried_load::CarriedLoad;
pub use place_area::{PlaceArea, reached_share};
pub use place_plan::PlacePlan;
pub use place_rejection::PlaceRejection;
pub use placing::{GraspedObject, PlacePose, PlacingPlanner, RELEASE_M};
pub use transit::{NoTransit, TransitKind, TransitPath, TransitPlanner};
pub use transport_planner::{NoTransport, ReachedGrasp, Transport, TransportPlanner, reach_region};
