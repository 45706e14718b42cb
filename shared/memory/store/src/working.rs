//! The working memory: which objects there are, what was known of them and when,
//! what the robot does, what happened, and which tasks were done.
//!
//! A [`WorldModel`] holds all of it in memory and answers every question; it does
//! no I/O and reads no clock. [`WorkingMemory`] is its copy on disk, and a
//! [`WorldThread`] writes what has changed, a few times a second at most.
//!
//! It is rebuilt by looking, so a damaged copy is set aside and begun anew, and a
//! loss of power may take the last changes that were not written yet.

mod event;
mod event_log;
mod expiry;
mod fact;
mod fact_table;
mod keys;
mod object;
mod on_disk;
mod query;
mod robot;
mod task;
mod task_table;
mod thread;
mod touched;
mod watching;
mod world_config;
mod world_model;

#[cfg(test)]
mod model_tests;

pub use event::{Event, Happening, Learned, Lesson, Outcome};
pub use fact::{Fact, Place, Property, Subject, Value};
pub use object::{Object, Sighting};
pub use on_disk::{WorkingMemory, WorldCondition, WorldReport};
pub use query::{FactPage, FactQuery, Region, Window};
pub use robot::{Robot, RobotSighting};
pub use task::{NewTask, Task, TaskEnd, TaskRefusal, TaskState};
pub use thread::{OnTrouble, WorldHandle, WorldThread, WorldThreadConfig};
pub use world_config::WorldConfig;
pub use world_model::WorldModel;
