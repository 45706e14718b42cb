//! Errors of the storage engine, as sentences that say what to do next.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Error of a database operation. It is cloned when one failed commit answers many callers.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed operating-system call, for example on a full disk.
    #[error(transparent)]
    Io(#[from] StorageFailure),
    /// Store folder that is locked by another process.
    #[error(
        "the store {} is open in another process; stop that process, or choose another folder",
        .folder.display()
    )]
    InUse {
        /// Folder of the store.
        folder: PathBuf,
    },
    /// Database written by a newer version of this program, according to the schema version that
    /// the owner of the records keeps in it.
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
        /// Description of the detected corruption.
        what: String,
    },
}

/// Failed operation on a file or folder.
#[derive(Debug, Clone, thiserror::Error)]
#[error(
    "{doing} {} failed: {source}; see that the disk has room and the folder belongs to the \
     daemon's user",
    .path.display()
)]
pub struct StorageFailure {
    /// Operation that failed, as a participle such as "writing".
    pub doing: &'static str,
    /// Path of the file or folder of the failed operation.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: Arc<io::Error>,
}

impl Error {
    /// Closure for `map_err` that adds the operation and the path to an I/O error.
    pub fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| {
            Self::Io(StorageFailure {
                doing,
                path,
                source: Arc::new(source),
            })
        }
    }
}
