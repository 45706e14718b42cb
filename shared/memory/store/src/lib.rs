//! Durable perceptual memory (learned views and their labels, over rusty-leveldb) and [working]
//! memory (a temporal world model).
//!
//! A mutation is acknowledged when it is on disk, is atomic, and is idempotent by its id.
//! Corruption is detected when the store is opened or a record is read; it is reported and never
//! returned as data.
//!
//! This crate never deletes a damaged database, never reads a clock (times are arguments), writes
//! no log (reports are return values), and depends neither on tokio, nor on the messages, nor on
//! the use of descriptors by recognition.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! use store::{Change, Error, Mutation, MutationId, PerceptualMemory, StoreRefusal};
//!
//! let (mut memory, report) = PerceptualMemory::open(folder.path(), 1)?;
//! assert!(!report.is_loss());
//! let track_id = memory.lease_track_ids(1)?;
//! let teach = Mutation {
//!     id: MutationId::random()?,
//!     author: "anna".to_owned(),
//!     wall_ns: 2,
//!     change: Change::Teach {
//!         track_id,
//!         category: learning::CategoryName::new("mug")?,
//!     },
//! };
//! // No view of the track is stored yet.
//! let refused = memory.apply(&teach);
//! assert!(matches!(refused, Err(Error::Refused(StoreRefusal::Teaching(_)))));
//! memory.close()?;
//! # Ok(())
//! # }
//! ```

mod digest;
mod document;
mod error;
mod exchange;
mod history;
mod label_status;
mod model;
mod mutation;
mod view;

mod perceptual_memory;
mod queries;
mod store_thread;

mod decide;
mod decision;
mod entry_applier;
mod importing;
mod maintenance;
mod purge;
mod retention_limits;
mod undo;
mod view_summary;

mod checkpoint;
mod consistency_check;
mod findings;
mod history_projection;
mod opening;
mod portable;
mod raw_database;
mod raw_log;
mod raw_table;
mod recovered_records;
mod replay;
mod salvage;
mod schema_1;
mod store_folder;
mod track_id_counter;
mod watermark;

mod keys;
mod meta;
mod record;
mod record_batch;
mod record_reader;
mod store_index;
mod view_record;

mod crc32c;
mod durable_env;
mod engine;
mod env_health;
mod verified_files;

pub mod working;

#[cfg(test)]
mod tests;

pub use checkpoint::{Checkpoint, CheckpointReader, Verification, verify_folder};
pub use digest::Digest;
pub use document::{
    DocumentContent, DocumentKey, DocumentKind, DocumentSummary, MAX_DOCUMENT_BYTES, MemoryDocument,
};
pub use engine::WRITE_BUFFER_BYTES;
pub use error::{Error, StoreRefusal};
pub use exchange::{ForeignDocument, ForeignView};
pub use history::HistoryEntry;
pub use label_status::{Decided, Standing};
pub use maintenance::Stats;
pub use meta::StoreId;
pub use model::{Answer, Contradiction, DataLoss, Effect, Limits, MutationId, Operation, Target};
pub use mutation::{Change, MAX_BATCH_BYTES, MAX_BATCH_VIEWS, Mutation};
pub use opening::{Condition, OpenReport};
pub use perceptual_memory::{MAX_LEASE, PerceptualMemory};
pub use portable::{PortableBatch, PortableCounts, PortableError, PortableReader, PortableWriter};
pub use queries::{ChangeEntry, Changes, LabelledView, NameChange, Position, SnapshotPage};
pub use store_index::CategorySummary;
pub use store_thread::{OnReopened, StoreConfig, StoreHandle, StoreThread};
pub use view::{
    Descriptor, MAX_DESCRIPTOR_VALUES, MAX_NAME_BYTES, MAX_POINTS_BYTES, Origin, StoredView, View,
};
pub use view_summary::ViewSummary;
