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

mod digest;
mod document;
mod error;
mod foreign;
mod history;
mod mutation;
mod standing;
mod view;

mod perceptual_memory;
mod reading;
mod store_thread;

mod applying;
mod decision;
mod economy;
mod importing;
mod listing;
mod maintenance;
mod purge;
mod undo;

mod checkpoint;
mod examination;
mod findings;
mod fold;
mod opening;
mod portable;
mod raw_database;
mod raw_log;
mod raw_table;
mod remains;
mod replay;
mod salvage;
mod schema_1;
mod store_folder;
mod track_id_counter;
mod watermark;

mod catalogue;
mod facts;
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
mod cpp_leveldb_tests;
#[cfg(test)]
mod power_loss_tests;

pub use catalogue::CategorySummary;
pub use checkpoint::{Checkpoint, CheckpointReader, Verification, verify_folder};
pub use digest::Digest;
pub use document::{
    Document, DocumentContent, DocumentKey, DocumentKind, DocumentSummary, MAX_DOCUMENT_BYTES,
};
pub use economy::Limits;
pub use engine::WRITE_BUFFER_BYTES;
pub use error::{Error, Refusal};
pub use foreign::{ForeignDocument, ForeignView};
pub use history::{Contradiction, Effect, HistoryEntry, Operation};
pub use listing::ViewSummary;
pub use maintenance::Stats;
pub use meta::StoreId;
pub use mutation::{
    Answer, Change, MAX_BATCH_BYTES, MAX_BATCH_VIEWS, Mutation, MutationId, Target,
};
pub use opening::{Condition, OpenReport};
pub use perceptual_memory::{MAX_LEASE, PerceptualMemory};
pub use portable::{Batch, PortableCounts, PortableError, PortableReader, PortableWriter};
pub use reading::{ChangeEntry, Changes, LabelledView, NameChange, Position, SnapshotPage};
pub use salvage::Loss;
pub use standing::{Decided, Standing};
pub use store_thread::{OnReopened, StoreConfig, StoreHandle, StoreThread};
pub use view::{
    Descriptor, MAX_DESCRIPTOR_VALUES, MAX_NAME_BYTES, MAX_POINTS_BYTES, Origin, StoredView, View,
};
