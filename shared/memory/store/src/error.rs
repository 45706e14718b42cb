//! Errors of the perceptual and the working memory, as sentences that say what to do next.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use learning::{CategoryName, ViewId};

use crate::engine::storage_error::StorageError;
use crate::perceptual::document::DocumentKey;
use crate::perceptual::keys;

/// Error of a store operation. It is cloned when one failed commit answers many callers.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Request that cannot be granted; the store is intact and nothing changed.
    #[error("{0}")]
    Refused(#[from] StoreRefusal),
    /// Failed operating-system call, for example on a full disk.
    #[error(
        "{doing} {} failed: {source}; see that the disk has room and the folder belongs to the \
         daemon's user",
        .path.display()
    )]
    Io {
        /// Operation that failed, as a participle such as "writing".
        doing: &'static str,
        /// File or folder of the operation.
        path: PathBuf,
        /// Error of the operating system.
        source: Arc<io::Error>,
    },
    /// Store folder that is locked by another process.
    #[error(
        "the store {} is open in another process; stop that process, or choose another folder",
        .folder.display()
    )]
    InUse {
        /// Folder of the store.
        folder: PathBuf,
    },
    /// Database written by a newer version of this program.
    #[error(
        "the store has schema {found}, and this program knows only up to {known}; update the \
         program, or choose another folder"
    )]
    NewerSchema {
        /// Schema version of the database.
        found: u32,
        /// Newest schema version that this program reads.
        known: u32,
    },
    /// Corrupted data on disk; opening the store again rebuilds it.
    #[error("the store is damaged ({what}); open it again to rebuild it")]
    Damaged {
        /// Description of the corruption.
        what: String,
    },
    /// Store made unusable by an earlier failed write, until it is opened again.
    #[error(
        "the store takes no more requests since an earlier one failed ({source}); send it again \
         after the store was opened again"
    )]
    Failed {
        /// Error of the earlier write.
        source: Arc<Error>,
    },
    /// Full request queue.
    #[error("{capacity} requests are waiting for the store already; send this one again later")]
    QueueFull {
        /// Capacity of the queue, requests.
        capacity: usize,
    },
    /// Store thread that has ended.
    #[error("the store has stopped; start it and send this again")]
    Stopped,
}

/// Reason for refusing a request.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreRefusal {
    /// Violated rule of teaching.
    #[error("{0}")]
    Teaching(#[from] learning::TeachingError),
    /// View id that is stored already with different content.
    #[error(
        "{} is stored already, with another content; give a new view a new id",
        in_words(*view)
    )]
    ViewDiffers {
        /// Id of the view.
        view: ViewId,
    },
    /// View with invalid values.
    #[error("{} cannot be stored because {reason}; send it again corrected", in_words(*view))]
    InvalidView {
        /// Id of the view.
        view: ViewId,
        /// Violated constraint.
        reason: &'static str,
    },
    /// Batch with no views or too many.
    #[error("{n_views} views were sent to be stored at once; send between 1 and {most}")]
    BatchSize {
        /// Number of views in the batch.
        n_views: usize,
        /// Maximum number of views in a batch.
        most: usize,
    },
    /// Batch with too many bytes.
    #[error("views of {n_bytes} bytes were sent to be stored at once; send at most {most}")]
    BatchBytes {
        /// Bytes of descriptors, point clouds and documents in the batch.
        n_bytes: usize,
        /// Maximum number of bytes in a batch.
        most: usize,
    },
    /// View that is not stored, or was forgotten.
    #[error(
        "{} is not stored; list the views of the track to see which there are",
        in_words(*view)
    )]
    UnknownView {
        /// Id of the view.
        view: ViewId,
    },
    /// New category name that is in use already.
    #[error(
        "{from} cannot be renamed to {to}, since there is a category of that name; merge the two \
         if they mean the same"
    )]
    NameTaken {
        /// Category to rename.
        from: CategoryName,
        /// New name.
        to: CategoryName,
    },
    /// Document with invalid values.
    #[error("{document} cannot be stored because {reason}; send it again corrected")]
    InvalidDocument {
        /// Key of the document.
        document: DocumentKey,
        /// Violated constraint.
        reason: &'static str,
    },
    /// Document that is not stored.
    #[error("{document} is not stored; list the documents to see which there are")]
    UnknownDocument {
        /// Key of the document.
        document: DocumentKey,
    },
    /// History entry that does not exist.
    #[error("the history has no entry {sequence}; read the history to see which there are")]
    UnknownEntry {
        /// Sequence number of the entry.
        sequence: u64,
    },
    /// Undo of an entry without effects, or by an author without a teaching entry.
    #[error("there is nothing to undo; name an entry of the history that changed something")]
    NothingToUndo,
    /// Undo of an entry whose view was changed later.
    #[error(
        "entry {sequence} cannot be undone, since entry {by} changed {} after it; undo that one \
         first",
        in_words(*view)
    )]
    ViewChangedSince {
        /// Sequence number of the entry to undo.
        sequence: u64,
        /// Id of the view.
        view: ViewId,
        /// Sequence number of the later entry.
        by: u64,
    },
    /// Undo of an entry whose document was changed later.
    #[error(
        "entry {sequence} cannot be undone, since {document} was changed after it; undo that \
         change first"
    )]
    DocumentChangedSince {
        /// Sequence number of the entry to undo.
        sequence: u64,
        /// Key of the document.
        document: DocumentKey,
    },
    /// Undo of an entry whose content was purged.
    #[error(
        "entry {sequence} cannot be undone, since what it changed was removed for good; teach it \
         again"
    )]
    GoneForGood {
        /// Sequence number of the entry to undo.
        sequence: u64,
    },
    /// Imported time stamp too far ahead of the local clock.
    #[error(
        "the other memory was taught {ahead_h} h from now by the clock of this robot; set the \
         clock that is wrong, and import it again"
    )]
    DecidedInTheFuture {
        /// Lead of the time stamp, hours.
        ahead_h: u64,
    },
    /// Target folder that holds a store already.
    #[error("the folder holds a store already; name an empty one")]
    NotEmpty,
    /// Exhausted track-id counter.
    #[error(
        "there are no numbers left for new tracks; export this memory and import it into a new one"
    )]
    TrackIdsExhausted,
    /// Author or source name above the length limit.
    #[error("the name of an author or a source has {n_bytes} bytes; use at most {most}")]
    AuthorTooLong {
        /// Length of the name, bytes.
        n_bytes: usize,
        /// Maximum length, bytes.
        most: usize,
    },
    /// View under a track-id that was never leased.
    #[error(
        "{} cannot be stored, since that track-id was never leased; lease track-ids first, and \
         store views under them",
        in_words(*view)
    )]
    TrackNotLeased {
        /// Id of the view.
        view: ViewId,
    },
    /// Lease of no track-ids, or of too many.
    #[error("{count} track-ids were asked for at once; ask for 1 to {most}")]
    LeaseSize {
        /// Number of track-ids in the request.
        count: u64,
        /// Maximum number of track-ids in a lease.
        most: u64,
    },
}

impl From<learning::TeachingError> for Error {
    fn from(refusal: learning::TeachingError) -> Self {
        Self::Refused(StoreRefusal::Teaching(refusal))
    }
}

impl From<StorageError> for Error {
    fn from(error: StorageError) -> Self {
        match error {
            StorageError::Io(failure) => Self::Io {
                doing: failure.doing,
                path: failure.path,
                source: failure.source,
            },
            StorageError::InUse { folder } => Self::InUse { folder },
            StorageError::Damaged { what } => Self::Damaged { what },
        }
    }
}

impl Error {
    /// Closure for `map_err` that adds the operation and the path to an I/O error.
    pub(crate) fn io(
        doing: &'static str,
        path: impl Into<PathBuf>,
    ) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io {
            doing,
            path,
            source: Arc::new(source),
        }
    }

    /// [`Error::Damaged`] about the record under `key`.
    pub(crate) fn record(key: &[u8], wrong: &str) -> Self {
        Self::Damaged {
            what: format!("{}: {wrong}", keys::in_words(key)),
        }
    }
}

/// Phrase for a view in sentences: "view 3 of track 7".
pub(crate) fn in_words(view: ViewId) -> String {
    format!("view {} of track {}", view.view_id, view.track_id)
}
