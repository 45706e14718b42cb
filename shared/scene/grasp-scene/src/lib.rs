//! Grasp scene of a snapshot: objects with stored models, support surfaces, people and the arm in
//! the frame of planning; places of the configuration.
//!
//! Invariants: this crate does no I/O and reads no clock; the result depends on its arguments
//! alone.

mod arm_placement;
mod hand_drawing;
mod model_contacts;
mod places;
mod snapshot_scene;

pub use arm_placement::placed_arm;
pub use hand_drawing::{draw_grasp, draw_transport};
pub use model_contacts::model_contacts;
pub use places::{PLACES_SECTION, PlaceConfig, Places};
pub use snapshot_scene::{SceneBodies, grasp_scene};
