//! Durable perceptual memory: learned views, their labels, and the history of both, in a
//! [durable LevelDB](durable_leveldb).
//!
//! [`PerceptualMemory`] is the open store, and a [`StoreThread`] owns it for many callers. A
//! [`Checkpoint`] is verified or exported while the store is in use.
//!
//! A mutation is acknowledged when it is on disk, is atomic, and is idempotent by its id.
//! Corruption is detected when the store is opened or a record is read; it is reported and never
//! returned as data.
//!
//! Old history entries are moved to an archive in steps; see [`HistoryLimits`].
//!
//! This crate keeps the two newest damaged databases, never reads a clock (times are arguments),
//! writes no log (reports are return values), and depends neither on tokio, nor on the messages,
//! nor on the use of descriptors by recognition.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! use perceptual_memory::{
//!     Error, Mutation, MutationId, PerceptualMemory, Requester, StoreChange, StoreRefusal,
//! };
//!
//! let (mut memory, report) = PerceptualMemory::open(folder.path(), 1)?;
//! assert!(!report.is_loss());
//! let track_id = memory.lease_track_ids(1)?;
//! let teach = Mutation {
//!     id: MutationId::random()?,
//!     author: "anna".to_owned(),
//!     requester: Requester::default(),
//!     wall_ns: 2,
//!     change: StoreChange::Teach {
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

mod archive;
mod archiving;
mod change_state;
mod changed_item;
mod checkpoint;
mod consistency_check;
mod decide;
mod decision;
mod digest;
mod document;
mod document_key;
mod entry_applier;
mod entry_reader;
mod error;
mod exchange;
mod findings;
mod history;
mod history_chain;
mod history_limits;
mod history_projection;
mod history_verification;
mod importing;
mod index_loading;
mod index_row;
mod keys;
mod label_status;
mod maintenance;
mod meta;
mod model;
mod mutation;
mod new_names;
mod opening;
mod perceptual_memory;
mod portable;
mod purge;
mod queries;
mod read_only;
mod record_batch;
mod record_reader;
mod recovered_records;
mod recovery;
mod reopening_pace;
mod replay;
mod requester;
mod retention_limits;
mod salvage;
mod schema_1;
mod set_digest;
mod size_record;
mod store_index;
mod store_thread;
mod tombstone;
mod touch_stack;
mod track_id_counter;
mod undo;
mod undo_list;
mod view;
mod view_phrase;
mod view_record;
mod view_summary;
mod watermark;

#[cfg(test)]
mod tests;

pub use archiving::ArchivingStep;
pub use changed_item::ChangedItem;
pub use checkpoint::{Checkpoint, CheckpointReader, Verification, verify_folder};
pub use digest::Digest;
pub use document::{
    DocumentContent, DocumentRevision, DocumentSummary, MAX_DOCUMENT_BYTES, MAX_DOCUMENT_VERSIONS,
    MemoryDocument,
};
pub use document_key::{DocumentKey, DocumentKind};
pub use durable_leveldb::{MutationId, WRITE_BUFFER_BYTES};
pub use error::{Error, StorageError, StoreRefusal};
pub use exchange::{ForeignDocument, ForeignView};
pub use history::HistoryEntry;
pub use history_limits::HistoryLimits;
pub use label_status::{DecisionStamp, LabelStatus};
pub use maintenance::Stats;
pub use meta::StoreId;
pub use model::{
    Contradiction, DataLoss, Effect, ImportPart, MutationReceipt, Operation, RetentionLimits,
    Target,
};
pub use mutation::{MAX_BATCH_BYTES, MAX_BATCH_VIEWS, Mutation, StoreChange};
pub use opening::{Condition, OpenReport};
pub use perceptual_memory::{MAX_LEASE, PerceptualMemory};
pub use portable::{PortableBatch, PortableCounts, PortableError, PortableReader, PortableWriter};
pub use queries::{ChangeEntry, Changes, LabelledView, NameChange, Position, SnapshotPage};
pub use requester::Requester;
pub use store_index::CategorySummary;
pub use store_thread::{OnNotice, OnReopened, StoreConfig, StoreHandle, StoreThread};
pub use undo::Reversal;
pub use view::{
    CapturedView, MAX_DESCRIPTOR_VALUES, MAX_NAME_BYTES, MAX_POINTS_BYTES, Origin,
    StoredDescriptor, StoredView,
};
pub use view_summary::ViewSummary;
