//! The simulated table: physics scene, simulated Kinect, arm, hand, ground truth.
//!
//! World frame: z up, origin on the floor under the middle of the table. A
//! [`Scene`] says what stands where; a [`World`] made from it advances in fixed
//! steps of 1/120 s; the same scene, seed and commands give the same world to
//! the bit.
//!
//! This crate never reads a clock, never logs, never starts a thread, and reads
//! files only where a function takes a path.

mod arm;
mod arrangement;
mod chance;
mod error;
mod glam_conversion;
mod model_file;
mod model_library;
mod object_model;
mod person;
mod physics;
mod room;
mod scene;
mod scene_file;
mod simulated_kinect;
mod truth;
mod world;

pub use arm::{ArmCommand, ArmMount, ArmStatus};
pub use arm_kinematics::MotionState;
pub use chance::stream as random_stream;
pub use error::Error;
pub use model_library::{ModelLibrary, category_names};
pub use object_model::{ObjectModel, Origin};
pub use person::{Action, PersonPlan, TimedAction};
pub use physics::{STEP_NS, STEPS_PER_SECOND};
pub use scene::{
    Bin, CameraMount, ModelChoice, ModelSource, ObjectPlan, Placing, Scene, SceneKind, Table,
};
pub use scene_file::MOST_OBJECTS;
pub use simulated_kinect::SimulatedKinect;
pub use truth::{ARM_ID, PERSON_ID, TrueObject, truth_json};
pub use world::{ObjectState, SceneObject, World};
