//! Grasp poses of a parallel gripper on unknown objects, from one depth image.
//!
//! A [`GraspScene`] holds the image, the pixels of each object, the support surfaces and people.
//! The surface of an object is what is seen of it, its occluding contour, and its hidden side by
//! mirror symmetry ([`contact_surface`]); a stored model takes the place of all three. Antipodal
//! pairs of its contact points, and squeezes across it, approached from above to the side, are
//! fitted with the hand, tested against [`Obstacles`] along approach, closing and lift, and against
//! the arm's reach ([`GraspPlanner`]). Bars, rims, handles and flat things are all pairs of
//! contacts; there is no list of shapes.
//!
//! Frames: that of planning has z against gravity. The tool's is between the finger pads, z along
//! the approach, x along the closing direction. Units are metres, radians and kilograms.
//!
//! Invariants: this crate does no I/O, reads no clock and draws no random numbers; a plan depends
//! on its arguments alone.

mod antipodal_pairs;
mod approach_directions;
mod contact_point;
mod grasp_plan;
mod grasp_planner;
mod grasp_scene;
mod grasp_settings;
mod hand_boxes;
mod hand_fit;
mod mirror_symmetry;
mod object_estimate;
mod observed_space;
mod observed_surface;
mod obstacles;
mod reach;
mod rejection;
mod squeeze_pairs;
mod surroundings;

pub use contact_point::{ContactEvidence, ContactPoint};
pub use grasp_plan::{ApproachKind, Grasp, GraspPlan, RejectedGrasp, ScoreFactors};
pub use grasp_planner::GraspPlanner;
pub use grasp_scene::{GraspObject, GraspScene, SupportPlane};
pub use grasp_settings::GraspSettings;
pub use hand_boxes::{hand_boxes, lowest_m, swept_back};
pub use object_estimate::contact_surface;
pub use observed_space::{ObservedSpace, SpaceState};
pub use obstacles::{Obstacle, Obstacles, box_meets_capsule};
pub use reach::{GraspJoints, N_BASE_CAPSULES, N_HAND_CAPSULES, PlacedArm};
pub use rejection::{GraspPhase, Rejection};
