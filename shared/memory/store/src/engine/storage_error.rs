//! Errors of the storage engine.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use crate::engine::env_health::StorageFailure;

/// Error of an engine operation, in the words of [`crate::Error`].
#[derive(Debug, Clone)]
pub(crate) enum StorageError {
    /// Failed operating-system call.
    Io(StorageFailure),
    /// Folder that is locked by another process.
    InUse {
        /// Locked folder.
        folder: PathBuf,
    },
    /// Corrupted data on disk.
    Damaged {
        /// Description of the corruption.
        what: String,
    },
}

impl StorageError {
    /// Closure for `map_err` that adds the operation and the path to an I/O error.
    pub(crate) fn io(
        doing: &'static str,
        path: impl Into<PathBuf>,
    ) -> impl FnOnce(io::Error) -> Self {
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

impl From<StorageFailure> for StorageError {
    fn from(failure: StorageFailure) -> Self {
        Self::Io(failure)
    }
}
