//! Working memory: a temporal world model of objects, surfaces, robot, events and tasks.
//!
//! A [`WorldModel`] holds everything in memory and answers all queries; it does no I/O and reads no
//! clock. [`WorkingMemory`] is its copy on disk, and a [`WorldThread`] writes the changes, at most
//! a few times per second.
//!
//! Observation rebuilds it. A damaged copy is therefore set aside and replaced by an empty one, and
//! a power cut may lose the last unwritten changes.
//!
//! Invariants:
//!
//! - A fact never ends before it begins, and a subject has one value of a property at a time.
//! - Unchanged observations write nothing and allocate nothing.
//! - Unwritten changes take no more memory than the model, however slow the disk.
//! - A step of a task begins when the one before it has ended, and never changes after its end.
//! - Numbers of facts, events and tasks are never reused, also after a restart.
//!
//! ```
//! use working_memory::{BoxPose, FactQuery, Sighting, WRITE_BUFFER_BYTES, WorldConfig, WorldModel};
//!
//! const SECOND: u64 = 1_000_000_000;
//! let mut model = WorldModel::new(WorldConfig {
//!     move_min_m: 0.02,
//!     turn_min_rad: 0.3,
//!     keep_ns: 3600 * SECOND,
//!     n_kept_most: 1000,
//!     seen_period_ns: 10 * SECOND,
//!     write_buffer_bytes: WRITE_BUFFER_BYTES,
//! });
//! let mug = |x_m, now_ns| Sighting {
//!     track_id: 7,
//!     state: "tracked",
//!     label: Some("mug"),
//!     is_probable: false,
//!     place: BoxPose {
//!         position_m: [x_m, 0.0, 0.7],
//!         orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
//!         size_m: [0.1; 3],
//!     },
//!     surface: None,
//!     first_seen_ns: SECOND,
//!     last_seen_ns: now_ns,
//! };
//! model.observe([mug(0.1, SECOND)], true, SECOND);
//! model.observe([mug(0.4, 2 * SECOND)], true, 2 * SECOND);
//!
//! let of_mugs = FactQuery {
//!     subject: None,
//!     label: Some("mug".to_owned()),
//!     region: None,
//!     window: None,
//!     before: None,
//!     n_most: 10,
//! };
//! // State, label, and two places, of which the first has ended.
//! let page = model.facts(&of_mugs);
//! assert_eq!(page.facts.len(), 4);
//! ```

mod dirty_set;
mod error;
mod event;
mod event_log;
mod expiry_queue;
mod fact;
mod fact_table;
mod object;
mod query;
mod record_key;
mod robot;
mod robot_update;
mod scene_update;
mod step_record;
mod surface;
mod surface_update;
mod task;
mod task_step;
mod task_table;
mod task_update;
mod working_memory;
mod world_config;
mod world_model;
mod world_thread;

#[cfg(test)]
mod tests;

pub use durable_leveldb::{MutationId, WRITE_BUFFER_BYTES};
pub use error::{Error, StorageError};
pub use event::{Event, EventKind, Lesson, LessonKind, Outcome, StepChange};
pub use fact::{BoxPose, Fact, Property, Subject, Value};
pub use object::{ObjectRecord, Sighting};
pub use query::{FactPage, FactQuery, Region, Window};
pub use robot::{Robot, RobotSighting};
pub use surface::{SurfaceRecord, SurfaceSighting};
pub use task::{NewTask, Task, TaskEnd, TaskRefusal, TaskState};
pub use task_step::{
    MAX_PLAN_BYTES, MAX_STEP_REASON_BYTES, MAX_STEP_WORD_BYTES, MAX_TASK_PLAN_BYTES,
    MAX_TASK_STEPS, StepContent, StepRefusal, StepState, TaskStep,
};
pub use working_memory::{WorkingMemory, WorldCondition, WorldReport};
pub use world_config::WorldConfig;
pub use world_model::WorldModel;
pub use world_thread::{OnTrouble, WorldHandle, WorldThread, WorldThreadConfig};
