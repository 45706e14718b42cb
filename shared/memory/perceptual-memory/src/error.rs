//! Errors of the perceptual memory, as sentences that say what to do next.

use std::path::PathBuf;
use std::sync::Arc;

use learning::{CategoryName, ViewId};
use unicode_text::{Likeness, likeness};

use crate::changed_item::ChangedItem;
use crate::document_key::DocumentKey;
use crate::undo::Reversal;
use crate::view_phrase::view_phrase;

pub use durable_leveldb::Error as StorageError;

/// Error of a store operation. It is cloned when one failed commit answers many callers.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Request that cannot be granted; the store is intact and nothing changed.
    #[error("{0}")]
    Refused(#[from] StoreRefusal),
    /// Error of the database and its folder.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// Store made unusable by an earlier failed write, until it is opened again.
    #[error(
        "the store takes no more requests since an earlier one failed ({source}); send it again \
         after the store was opened again"
    )]
    Failed {
        /// Error of the earlier failed write.
        source: Arc<Error>,
    },
    /// Change of a store that can only be read, until its disk can be written again.
    #[error(
        "nothing can be stored now: {source}; what is known can be read, and the store is opened \
         again as soon as it can be written"
    )]
    ReadOnly {
        /// Error that keeps the store from being written.
        source: Arc<Error>,
    },
    /// Damaged file of the archived history. The store itself goes on without its entries.
    #[error(
        "the archived history in {} is damaged: {what}; the memory is sound without it; to note \
         its entries as lost: tabula memory repair",
        .path.display()
    )]
    ArchiveDamaged {
        /// Path of the damaged file.
        path: PathBuf,
        /// Description of the damage.
        what: String,
    },
    /// Full request queue of the store thread.
    #[error("{capacity} requests are waiting for the store already; send this one again later")]
    QueueFull {
        /// Capacity of the queue, requests.
        capacity: usize,
    },
    /// Store thread that has ended.
    #[error("the store has stopped; start it and send this again")]
    Stopped,
}

/// Reason why the store refuses a request.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StoreRefusal {
    /// Violated rule of teaching.
    #[error("{0}")]
    Teaching(#[from] learning::TeachingError),
    /// View id that is stored already with different content.
    #[error(
        "{} is stored already, with another content; give a new view a new id",
        view_phrase(*view)
    )]
    ViewDiffers {
        /// Id of the conflicting view.
        view: ViewId,
    },
    /// View with invalid values.
    #[error("{} cannot be stored because {reason}; send it again corrected", view_phrase(*view))]
    InvalidView {
        /// Id of the invalid view.
        view: ViewId,
        /// Constraint that the view violates.
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
    /// Batch of views with too many bytes.
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
        view_phrase(*view)
    )]
    UnknownView {
        /// Id of the missing view.
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
        /// New category name that is in use.
        to: CategoryName,
    },
    /// New category whose name is like that of another one.
    #[error(
        "{name} would be a new category beside {existing}, which {}; use that name, or make the new \
         category all the same with --new",
        phrase_of_likeness(name, existing)
    )]
    NameAlike {
        /// Name of the new category.
        name: CategoryName,
        /// Name of the category that is there.
        existing: CategoryName,
    },
    /// Document with invalid values.
    #[error("{document} cannot be stored because {reason}; send it again corrected")]
    InvalidDocument {
        /// Key of the invalid document.
        document: DocumentKey,
        /// Reason why the document is invalid.
        reason: &'static str,
    },
    /// Document that is not stored.
    #[error("{document} is not stored; list the documents to see which there are")]
    UnknownDocument {
        /// Key of the missing document.
        document: DocumentKey,
    },
    /// History entry that does not exist.
    #[error("the history has no entry {sequence}; read the history to see which there are")]
    UnknownEntry {
        /// Sequence number of the missing entry.
        sequence: u64,
    },
    /// Undo of an entry without effects, or by an author without a change that is in effect.
    #[error("there is nothing to undo; name an entry of the history that changed something")]
    NothingToUndo,
    /// Redo by an author who undid nothing since the last change.
    #[error(
        "there is nothing to redo, since nothing was undone after the last change; to take back an \
         earlier undo, undo its entry by its number"
    )]
    NothingToRedo,
    /// Undo of an entry that is undone already.
    #[error(
        "entry {sequence} is not in effect any more, since entry {by} undid it; undo that one to \
         bring it back"
    )]
    UndoneAlready {
        /// Sequence number of the entry to undo.
        sequence: u64,
        /// Sequence number of the entry that undid it.
        by: u64,
    },
    /// Undo of another user's entry without the right to.
    #[error(
        "entry {sequence} was made by another user, as {author:?}; only that user or an \
         administrator may undo it"
    )]
    OthersEntry {
        /// Sequence number of the entry to undo.
        sequence: u64,
        /// Author of the entry, as its client claimed.
        author: Arc<str>,
    },
    /// Undo or redo of an entry whose view or document was changed later.
    #[error(
        "entry {sequence} cannot be {reversal}, since entry {by}{} changed {item} after it; undo \
         that one first, or name another entry",
        by_author(author.as_deref())
    )]
    ChangedSince {
        /// Sequence number of the entry to undo or redo.
        sequence: u64,
        /// Direction that was asked for.
        reversal: Reversal,
        /// View or document that was changed later.
        item: ChangedItem,
        /// Sequence number of the later entry that changed it.
        by: u64,
        /// Author of that entry, as its client claimed; `None` if the entry is lost.
        author: Option<Arc<str>>,
    },
    /// Undo or redo of an entry whose content was purged.
    #[error(
        "entry {sequence} cannot be {reversal}, since the content it changed was permanently \
         deleted; teach it again, or name another entry"
    )]
    GoneForGood {
        /// Sequence number of the entry to undo or redo.
        sequence: u64,
        /// Direction that was asked for.
        reversal: Reversal,
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
        /// Maximum length of the name, bytes.
        most: usize,
    },
    /// View under a track-id that was never leased.
    #[error(
        "{} cannot be stored, since that track-id was never leased; lease track-ids first, and \
         store views under them",
        view_phrase(*view)
    )]
    TrackNotLeased {
        /// Id of the view under that track-id.
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

/// Author of an entry as a part of a sentence; empty if it is not known.
fn by_author(author: Option<&str>) -> String {
    let known = author.filter(|author| !author.is_empty());
    known.map_or_else(String::new, |author| format!(" by {author}"))
}

/// Likeness of the name of a category to a new one, as a part of a sentence.
fn phrase_of_likeness(name: &CategoryName, existing: &CategoryName) -> &'static str {
    match likeness(name.as_str(), existing.as_str()) {
        Some(Likeness::SameText) => {
            "is the same text in another form of Unicode, to be joined by tabula memory repair"
        }
        Some(Likeness::SameLetters) => "differs only in upper and lower case",
        _ => "looks like it",
    }
}
