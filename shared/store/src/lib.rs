//! Perceptual memory over rusty-leveldb with a durable environment: what a
//! person taught, and the views it was taught with. And the [working] memory:
//! what is and was there.
//!
//! A change is acknowledged when it is on disk, is made whole or not at all, and
//! is made once however often it is asked for. What is damaged is found when the
//! store is opened or the record is read, and is told, never taken for truth.
//!
//! This crate never deletes a damaged database, never reads a clock (times are
//! arguments), writes no log (what is worth telling is returned), and knows
//! nothing of tokio, messages, or how recognition uses the descriptors.

mod error;
mod history;
mod mutation;
mod view;

mod perceptual_memory;
mod reading;
mod store_thread;

mod examination;
mod opening;
mod salvage;
mod store_folder;
mod watermark;

mod catalogue;
mod keys;
mod meta;
mod record;
mod writes;

mod crc32c;
mod durable_env;
mod engine;
mod env_health;
mod verified_files;

pub mod working;

#[cfg(test)]
mod power_loss_tests;

pub use catalogue::CategorySummary;
pub use error::{Error, Refusal};
pub use history::{HistoryEntry, Operation};
pub use meta::StoreId;
pub use mutation::{Answer, Change, MAX_BATCH_BYTES, MAX_BATCH_VIEWS, Mutation, MutationId};
pub use opening::{Condition, OpenReport};
pub use perceptual_memory::{MAX_LEASE, PerceptualMemory};
pub use reading::{ChangeEntry, Changes, LabelledView, NameChange, Position, SnapshotPage};
pub use salvage::Loss;
pub use store_thread::{OnReopened, StoreConfig, StoreHandle, StoreThread};
pub use view::{
    Descriptor, Label, MAX_DESCRIPTOR_VALUES, MAX_NAME_BYTES, MAX_POINTS_BYTES, StoredView, View,
};
