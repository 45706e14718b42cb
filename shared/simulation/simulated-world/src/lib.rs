//! Simulated table: physics scene, Kinect, arm, person and ground truth.
//!
//! World frame: z up, origin on the floor under the middle of the table. A [`Scene`] describes
//! the objects and their placement; a [`World`] made from it advances in fixed steps of 1/120 s.
//! The same scene, seed and commands give the same world to the bit.
//!
//! ```
//! use geometry::PinholeCamera;
//! use point_cloud::Point;
//! use simulated_world::{ModelLibrary, Scene, SceneKind, SimulatedKinect, World};
//!
//! let mut library = ModelLibrary::generated();
//! let scene = Scene::generate(SceneKind::Isolated, 2, 1, &mut library)?;
//! let mut world = World::new(scene, library)?;
//! world.step();
//! let camera = PinholeCamera::KINECT_V1;
//! let mut kinect = SimulatedKinect::new(&world, camera)?;
//! let mut points = vec![Point::default(); camera.n_pixels()];
//! let truth = kinect.look(&world, 0, &mut points)?;
//! assert_eq!(truth.len(), 2);
//! assert!(truth.iter().all(|object| object.visible_fraction() > 0.5));
//! # Ok::<(), simulated_world::Error>(())
//! ```
//!
//! Invariants: this crate never reads a clock, never logs, never starts a thread, and reads files
//! only in functions that take a path.

mod action;
mod arm;
mod arm_mount;
mod arrangement;
mod camera_mount;
mod error;
mod furniture;
mod glam_conversion;
mod ground_truth;
mod lighting;
mod model_choice;
mod model_file;
mod model_import;
mod model_library;
mod object_model;
mod person;
mod physics;
mod random_stream;
mod room;
mod scene;
mod scene_file;
mod scene_object;
mod simulated_kinect;
mod upright_axis;
mod world;

pub use action::{Action, PersonPlan, TimedAction};
pub use arm::{ArmCommand, ArmStatus};
pub use arm_kinematics::MotionState;
pub use arm_mount::ArmMount;
pub use camera_mount::CameraMount;
pub use error::Error;
pub use furniture::{Bin, Shelf, TableDimensions, TableFinish, TablePattern, Tray};
pub use ground_truth::{ARM_ID, ObjectTruth, PERSON_ID, truth_from_json, truth_json};
pub use lighting::Lighting;
pub use model_choice::{ModelChoice, ModelSource};
pub use model_import::{ModelImport, ModelUnit};
pub use model_library::{ModelLibrary, category_names};
pub use object_model::{ModelOrigin, ObjectModel};
pub use physics::{STEP_NS, STEPS_PER_SECOND};
pub use random_stream::random_stream;
pub use scene::{ObjectPlacement, ObjectPlan, Scene, SceneKind};
pub use scene_file::{EVERYDAY_OBJECTS, MAX_OBJECTS};
pub use scene_object::{ObjectState, SimulatedObject};
pub use simulated_kinect::SimulatedKinect;
pub use world::World;
