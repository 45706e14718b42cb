//! Working memory: a temporal world model of objects, robot, events and tasks.
//!
//! A [`WorldModel`] holds everything in memory and answers all queries; it does no I/O and reads no
//! clock. [`WorkingMemory`] is its copy on disk, and a [`WorldThread`] writes the changes, at most
//! a few times per second.
//!
//! Observation rebuilds it. A damaged copy is therefore set aside and replaced by an empty one, and
//! a power cut may lose the last unwritten changes.

mod dirty_set;
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
mod task;
mod task_table;
mod task_update;
mod working_memory;
mod world_config;
mod world_model;
mod world_thread;

#[cfg(test)]
mod tests;

pub use event::{ActionOutcome, Event, EventKind, TeachingEvent, TeachingKind};
pub use fact::{BoxPose, Fact, Property, Subject, Value};
pub use object::{ObjectRecord, Sighting};
pub use query::{FactPage, FactQuery, Region, Window};
pub use robot::{Robot, RobotSighting};
pub use task::{NewTask, Task, TaskEnd, TaskRefusal, TaskState};
pub use working_memory::{WorkingMemory, WorldCondition, WorldReport};
pub use world_config::WorldConfig;
pub use world_model::WorldModel;
pub use world_thread::{OnTrouble, WorldHandle, WorldThread, WorldThreadConfig};
