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
//! use store::{StoreChange, Error, Mutation, PerceptualMemory, StoreRefusal};
//!
//! let (mut memory, report) = PerceptualMemory::open(folder.path(), 1)?;
//! assert!(!report.is_loss());
//! let track_id = memory.lease_track_ids(1)?;
//! let teach = Mutation {
//!     id: MutationId::random()?,
//!     author: "anna".to_owned(),
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

mod engine;
mod error;
mod mutation_id;
mod perceptual;

pub mod working;

#[cfg(test)]
mod tests;

pub use engine::database::WRITE_BUFFER_BYTES;
pub use error::{Error, StoreRefusal};
pub use mutation_id::MutationId;
pub use perceptual::checkpoint::{Checkpoint, CheckpointReader, Verification, verify_folder};
pub use perceptual::digest::Digest;
pub use perceptual::document::{
    DocumentContent, DocumentKey, DocumentKind, DocumentSummary, MAX_DOCUMENT_BYTES, MemoryDocument,
};
pub use perceptual::exchange::{ForeignDocument, ForeignView};
pub use perceptual::history::HistoryEntry;
pub use perceptual::label_status::{DecisionStamp, LabelStatus};
pub use perceptual::maintenance::Stats;
pub use perceptual::meta::StoreId;
pub use perceptual::model::{
    Contradiction, DataLoss, Effect, MutationReceipt, Operation, RetentionLimits, Target,
};
pub use perceptual::mutation::{MAX_BATCH_BYTES, MAX_BATCH_VIEWS, Mutation, StoreChange};
pub use perceptual::opening::{Condition, OpenReport};
pub use perceptual::perceptual_memory::{MAX_LEASE, PerceptualMemory};
pub use perceptual::portable::{
    PortableBatch, PortableCounts, PortableError, PortableReader, PortableWriter,
};
pub use perceptual::queries::{
    ChangeEntry, Changes, LabelledView, NameChange, Position, SnapshotPage,
};
pub use perceptual::store_index::CategorySummary;
pub use perceptual::store_thread::{OnReopened, StoreConfig, StoreHandle, StoreThread};
pub use perceptual::view::{
    CapturedView, MAX_DESCRIPTOR_VALUES, MAX_NAME_BYTES, MAX_POINTS_BYTES, Origin,
    StoredDescriptor, StoredView,
};
pub use perceptual::view_summary::ViewSummary;
