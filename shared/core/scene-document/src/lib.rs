//! Typed documents of what the robot perceives and knows: object, scene, event, category, task,
//! model, health.
//!
//! `--json` prints them, recordings hold them, the world model reports them. A field says its unit
//! in its name; what is unknown is null. The JSON Schema of each is derived from its type
//! ([`schema`]), and its bytes are pinned by golden files.
//!
//! This crate has types and words only: messages in shared memory are converted to documents in
//! `message::document`, and records of the memories in their programs.
//!
//! ```
//! use scene_document::{CategoryAnswer, Document, ObjectDocument, schema};
//!
//! let mug = ObjectDocument {
//!     track_id: 7,
//!     label: Some("mug".to_owned()),
//!     answer: CategoryAnswer::Is,
//!     ..ObjectDocument::default()
//! };
//! let json = serde_json::to_value(&mug).unwrap();
//! assert_eq!((&json["label"], &json["answer"]), (&"mug".into(), &"is".into()));
//! let schema = schema::<ObjectDocument>();
//! assert_eq!(schema.get("title"), Some(&ObjectDocument::NAME.into()));
//! ```

mod category;
mod event;
mod health;
mod model;
mod object;
mod rejected;
mod scene;
mod schema;
mod task;
mod track_state;
mod world;

pub use category::CategoryDocument;
pub use event::{EventDocument, EventsDocument};
pub use health::HealthDocument;
pub use model::{ModelDocument, ModelViewDocument, RefusedViewDocument};
pub use object::{
    ActorStampsDocument, CategoryAnswer, ColorShareDocument, CovarianceDocument,
    NearCategoryDocument, ObjectDocument,
};
pub use rejected::{FindingDocument, RejectedDocument};
pub use scene::{AssumptionDocument, CameraPoseDocument, SceneDocument, SurfaceDocument};
pub use schema::{Document, schema};
pub use task::{TaskDocument, TaskStepDocument, TasksDocument};
pub use track_state::TrackState;
pub use world::{
    FactDocument, FactsDocument, PlaceDocument, RobotDocument, WorldDocument, WorldObjectDocument,
    WorldSurfaceDocument,
};

/// Number of joints of the arm.
pub const ARM_JOINTS: usize = 6;
