//! What can go wrong with the store, in sentences.

use std::fmt;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use learning::{CategoryName, ViewId};

use crate::document::DocumentKey;
use crate::env_health::Failure;
use crate::keys;

/// Why the store did not do what it was asked. Cloned when one failed commit
/// answers many callers.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Error {
    /// The request cannot be granted; the store is well and nothing changed.
    Refused(Refusal),
    /// The operating system refused something, such as room on the disk.
    Io {
        /// What was being done.
        doing: &'static str,
        /// To which file or folder.
        path: PathBuf,
        /// What the system said.
        source: Arc<io::Error>,
    },
    /// Another process has the store open.
    InUse {
        /// The store's folder.
        folder: PathBuf,
    },
    /// The store was written by a newer version of this program.
    NewerSchema {
        /// The schema found.
        found: u32,
        /// The newest schema this version knows.
        known: u32,
    },
    /// Something on disk is not what was written; open the store again to rebuild it.
    Damaged {
        /// What was found, in words.
        what: String,
    },
    /// An earlier change could not be written; open the store again.
    Failed {
        /// That earlier error.
        source: Arc<Error>,
    },
    /// More requests are waiting than the queue holds.
    QueueFull {
        /// How many it holds.
        capacity: usize,
    },
    /// The store's thread has stopped.
    Stopped,
}

/// Why a request cannot be granted.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// The rules of teaching forbid it.
    Lesson(learning::Refusal),
    /// A view with this id, but with another content, is stored.
    ViewDiffers {
        /// The view.
        view: ViewId,
    },
    /// A view, or the batch it came in, cannot be stored.
    InvalidView {
        /// The view.
        view: ViewId,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A mutation carries a list of views that is empty or too long.
    BatchSize {
        /// Number of views in it.
        n_views: usize,
        /// Most views that one mutation may carry.
        most: usize,
    },
    /// The views of a mutation are too large together.
    BatchBytes {
        /// Bytes of their descriptors and clouds.
        n_bytes: usize,
        /// Most bytes that one mutation may store.
        most: usize,
    },
    /// There is no such view, or it was forgotten.
    UnknownView {
        /// The view.
        view: ViewId,
    },
    /// A category was to get a name that another has.
    NameTaken {
        /// The category.
        from: CategoryName,
        /// The name.
        to: CategoryName,
    },
    /// A document cannot be stored.
    InvalidDocument {
        /// Which one.
        document: DocumentKey,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// There is no such document.
    UnknownDocument {
        /// Which one.
        document: DocumentKey,
    },
    /// The history has no such entry.
    UnknownEntry {
        /// Its sequence.
        sequence: u64,
    },
    /// The entry changed nothing, or there is none to take back.
    NothingToUndo,
    /// A view was touched since by another entry.
    ViewChangedSince {
        /// The entry that was to be undone.
        sequence: u64,
        /// The view.
        view: ViewId,
        /// The entry that touched it since.
        by: u64,
    },
    /// A document was replaced since.
    DocumentChangedSince {
        /// The entry that was to be undone.
        sequence: u64,
        /// The document.
        document: DocumentKey,
    },
    /// What the entry changed has been removed for good.
    GoneForGood {
        /// The entry.
        sequence: u64,
    },
    /// Another memory decided something in the future.
    DecidedInTheFuture {
        /// How far, hours.
        ahead_h: u64,
    },
    /// A folder holds a store already.
    NotEmpty,
    /// There are no numbers left for new tracks.
    TrackIdsExhausted,
    /// The author's name, or that of a source, is too long.
    AuthorTooLong {
        /// Its length, bytes.
        n_bytes: usize,
        /// The longest allowed, bytes.
        most: usize,
    },
    /// A view is to be stored under a track-id that was never leased.
    TrackNotLeased {
        /// The view.
        view: ViewId,
    },
    /// A lease of no track-ids, or of too many.
    LeaseSize {
        /// Number asked for.
        count: u64,
        /// Most that one lease gives.
        most: u64,
    },
}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

impl From<learning::Refusal> for Refusal {
    fn from(refusal: learning::Refusal) -> Self {
        Self::Lesson(refusal)
    }
}

impl From<learning::Refusal> for Error {
    fn from(refusal: learning::Refusal) -> Self {
        Self::Refused(Refusal::Lesson(refusal))
    }
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        Self::Io {
            doing: failure.doing,
            path: failure.path,
            source: failure.source,
        }
    }
}

impl Error {
    /// For use with `map_err` on a call about `path`.
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
}

impl Error {
    /// A record that is not what was written.
    pub(crate) fn record(key: &[u8], wrong: &str) -> Self {
        Self::Damaged {
            what: format!("{}: {wrong}", keys::in_words(key)),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => write!(f, "{refusal}"),
            Self::Io {
                doing,
                path,
                source,
            } => write!(
                f,
                "{doing} {} failed: {source}; see that the disk has room and the folder belongs \
                 to the daemon's user",
                path.display()
            ),
            Self::InUse { folder } => write!(
                f,
                "the store {} is open in another process; stop that process, or choose another \
                 folder",
                folder.display()
            ),
            Self::NewerSchema { found, known } => write!(
                f,
                "the store has schema {found}, and this program knows only up to {known}; update \
                 the program, or choose another folder"
            ),
            Self::Damaged { what } => {
                write!(
                    f,
                    "the store is damaged ({what}); open it again to rebuild it"
                )
            }
            Self::Failed { source } => write!(
                f,
                "the store takes no more requests since an earlier one failed ({source}); send \
                 it again after the store was opened again"
            ),
            Self::QueueFull { capacity } => write!(
                f,
                "{capacity} requests are waiting for the store already; send this one again later"
            ),
            Self::Stopped => write!(f, "the store has stopped; start it and send this again"),
        }
    }
}

impl fmt::Display for Refusal {
    #[expect(clippy::too_many_lines, reason = "a sentence for each refusal")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lesson(refusal) => write!(f, "{refusal}"),
            Self::ViewDiffers { view } => write!(
                f,
                "{} is stored already, with another content; give a new view a new id",
                in_words(*view)
            ),
            Self::InvalidView { view, reason } => {
                let view = in_words(*view);
                write!(
                    f,
                    "{view} cannot be stored because {reason}; send it again corrected"
                )
            }
            Self::BatchSize { n_views, most } => write!(
                f,
                "{n_views} views were sent to be stored at once; send between 1 and {most}"
            ),
            Self::BatchBytes { n_bytes, most } => write!(
                f,
                "views of {n_bytes} bytes were sent to be stored at once; send at most {most}"
            ),
            Self::UnknownView { view } => write!(
                f,
                "{} is not stored; list the views of the track to see which there are",
                in_words(*view)
            ),
            Self::NameTaken { from, to } => write!(
                f,
                "{from} cannot be renamed to {to}, since there is a category of that name; merge \
                 the two if they mean the same"
            ),
            Self::InvalidDocument { document, reason } => write!(
                f,
                "{document} cannot be stored because {reason}; send it again corrected"
            ),
            Self::UnknownDocument { document } => {
                write!(
                    f,
                    "{document} is not stored; list the documents to see which there are"
                )
            }
            Self::UnknownEntry { sequence } => write!(
                f,
                "the history has no entry {sequence}; read the history to see which there are"
            ),
            Self::NothingToUndo => write!(
                f,
                "there is nothing to undo; name an entry of the history that changed something"
            ),
            Self::ViewChangedSince { sequence, view, by } => write!(
                f,
                "entry {sequence} cannot be undone, since entry {by} changed {} after it; undo \
                 that one first",
                in_words(*view)
            ),
            Self::DocumentChangedSince { sequence, document } => write!(
                f,
                "entry {sequence} cannot be undone, since {document} was changed after it; undo \
                 that change first"
            ),
            Self::GoneForGood { sequence } => write!(
                f,
                "entry {sequence} cannot be undone, since what it changed was removed for good; \
                 teach it again"
            ),
            Self::TrackIdsExhausted => write!(
                f,
                "there are no numbers left for new tracks; export this memory and import it into \
                 a new one"
            ),
            Self::TrackNotLeased { view } => write!(
                f,
                "{} cannot be stored, since that track-id was never leased; lease track-ids \
                 first, and store views under them",
                in_words(*view)
            ),
            Self::DecidedInTheFuture { ahead_h } => write!(
                f,
                "the other memory was taught {ahead_h} h from now by the clock of this robot; set \
                 the clock that is wrong, and import it again"
            ),
            Self::NotEmpty => write!(f, "the folder holds a store already; name an empty one"),
            Self::AuthorTooLong { n_bytes, most } => {
                write!(
                    f,
                    "the name of an author or a source has {n_bytes} bytes; use at most {most}"
                )
            }
            Self::LeaseSize { count, most } => {
                write!(
                    f,
                    "{count} track-ids were asked for at once; ask for 1 to {most}"
                )
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Refused(refusal) => Some(refusal),
            Self::Io { source, .. } => Some(source.as_ref()),
            Self::Failed { source } => Some(source.as_ref()),
            _ => None,
        }
    }
}

impl std::error::Error for Refusal {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Lesson(refusal) => Some(refusal),
            _ => None,
        }
    }
}

/// A view as people call it.
pub(crate) fn in_words(view: ViewId) -> String {
    format!("view {} of track {}", view.view_id, view.track_id)
}
