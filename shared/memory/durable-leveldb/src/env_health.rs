//! Health monitor of the environment: failed writes and detected corruption, shared with the
//! engine.
//!
//! rusty-leveldb ignores some fatal errors: a compaction that cannot write its output, or cannot
//! read its input, deletes the input all the same. The monitor therefore keeps the first failed
//! write and all detected corruption, and then refuses every further change to the folder.

use std::io;
use std::path::Path;
use std::sync::Arc;

use parking_lot::Mutex;

use crate::error::{Error, StorageFailure};

/// Maximum number of corruptions kept as sentences; further ones are only counted.
const MAX_DAMAGE_SENTENCES: usize = 32;

/// Health monitor; thread-safe.
#[derive(Default)]
pub(crate) struct EnvHealth {
    state: Mutex<HealthState>,
}

#[derive(Default)]
struct HealthState {
    failure: Option<StorageFailure>,
    damages: Vec<String>,
    n_damages: u64,
    access: Access,
    observer: Option<Observer>,
}

/// Access to the files of a database.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Access {
    #[default]
    Writing,
    /// Reading of a database that was not accepted yet: corruption does not stop it.
    Examination,
    /// Examination of a snapshot, whose files are gone when the database has been opened again.
    Snapshot,
}

/// Hook that is called before every file operation and can make it fail: for crash tests that
/// record or refuse operations.
pub type Observer = Box<dyn FnMut(&FileOperation<'_>) -> io::Result<()> + Send>;

/// Operation on a file or folder of the database, as seen by an [`Observer`].
#[derive(Debug)]
pub enum FileOperation<'a> {
    /// Reading of a database file, once for each attempt.
    Read(&'a Path),
    /// Creation of a database file.
    Create(&'a Path),
    /// Bytes appended to a database file.
    Write(&'a Path, &'a [u8]),
    /// `fdatasync` of a database file.
    Sync(&'a Path),
    /// Renaming of the file at the first path to the second.
    Rename(&'a Path, &'a Path),
    /// Deletion of a database file.
    Delete(&'a Path),
    /// `fsync` of the database folder.
    SyncFolder(&'a Path),
}

impl EnvHealth {
    /// Monitor of a database that is only read until [`Self::end_examination`].
    pub(crate) fn examining() -> Self {
        Self::of(Access::Examination)
    }

    /// Monitor of a snapshot, which is only read.
    pub(crate) fn of_snapshot() -> Self {
        Self::of(Access::Snapshot)
    }

    fn of(access: Access) -> Self {
        let state = HealthState {
            access,
            ..HealthState::default()
        };
        Self {
            state: Mutex::new(state),
        }
    }

    /// Performs an operation, unless the database is only examined, an earlier operation failed, or
    /// corruption was found. Records a failure.
    pub(crate) fn perform<T>(
        &self,
        doing: &'static str,
        path: &Path,
        change: &FileOperation<'_>,
        make: impl FnOnce() -> io::Result<T>,
    ) -> io::Result<T> {
        self.refuse_if_frozen()?;
        let made = self.observe(change).and_then(|()| make());
        if let Err(error) = &made {
            self.note_failure(doing, path, error);
        }
        made
    }

    fn refuse_if_frozen(&self) -> io::Result<()> {
        let state = self.state.lock();
        if let Some(failure) = &state.failure {
            return Err(io::Error::new(
                failure.source.kind(),
                "an earlier write failed",
            ));
        }
        if state.access != Access::Writing {
            return Err(io::Error::new(
                io::ErrorKind::ReadOnlyFilesystem,
                "the database is open for reading only",
            ));
        }
        if state.n_damages > 0 {
            return Err(io::Error::other("damage was found, so nothing may change"));
        }
        Ok(())
    }

    /// Records a read error: as corruption if the bytes are lost, as a failure if only a resource
    /// is missing.
    pub(crate) fn note_read_error(&self, path: &Path, error: &io::Error) {
        /// Linux error codes for bytes that the medium or the file system has lost.
        const EIO: i32 = 5;
        const EBADMSG: i32 = 74;
        const EUCLEAN: i32 = 117;
        let is_gone =
            error.kind() == io::ErrorKind::NotFound && self.state.lock().access == Access::Snapshot;
        let is_lost = matches!(
            error.kind(),
            io::ErrorKind::NotFound
                | io::ErrorKind::UnexpectedEof
                | io::ErrorKind::InvalidData
                // A file name that does not exist, read from a damaged file.
                | io::ErrorKind::InvalidInput
                | io::ErrorKind::InvalidFilename
                | io::ErrorKind::IsADirectory
                | io::ErrorKind::NotADirectory
        ) || matches!(error.raw_os_error(), Some(EIO | EBADMSG | EUCLEAN));
        if is_lost && !is_gone {
            self.note_damage(format!("{}: {error}", path.display()));
        } else {
            self.note_failure("reading", path, error);
        }
    }

    /// Records the error of a read and passes the result on.
    pub(crate) fn noted<T>(&self, path: &Path, read: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &read {
            self.note_read_error(path, error);
        }
        read
    }

    fn note_failure(&self, doing: &'static str, path: &Path, error: &io::Error) {
        let copy = io::Error::new(error.kind(), error.to_string());
        let failure = StorageFailure {
            doing,
            path: path.to_owned(),
            source: Arc::new(copy),
        };
        self.state.lock().failure.get_or_insert(failure);
    }

    /// Records a detected corruption.
    pub(crate) fn note_damage(&self, what: String) {
        let mut state = self.state.lock();
        state.n_damages += 1;
        if state.damages.len() < MAX_DAMAGE_SENTENCES {
            state.damages.push(what);
        }
    }

    /// `true` during the examination: corruption does not stop reading, and nothing is changed.
    pub(crate) fn is_examining(&self) -> bool {
        self.state.lock().access != Access::Writing
    }

    /// Ends the examination.
    pub(crate) fn end_examination(&self) {
        self.state.lock().access = Access::Writing;
    }

    /// First failed file operation.
    pub(crate) fn failure(&self) -> Option<StorageFailure> {
        self.state.lock().failure.clone()
    }

    /// Number of detected corruptions, and the first ones as sentences.
    pub(crate) fn damages(&self) -> (u64, Vec<String>) {
        let state = self.state.lock();
        (state.n_damages, state.damages.clone())
    }

    /// Number of detected corruptions.
    pub(crate) fn n_damages(&self) -> u64 {
        self.state.lock().n_damages
    }

    /// Error of a failed file operation or, outside of the examination, of corruption.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if let Some(failure) = self.failure() {
            return Err(failure.into());
        }
        if self.n_damages() > 0 && !self.is_examining() {
            return Err(Error::Damaged {
                what: self.damages().1.join("; "),
            });
        }
        Ok(())
    }

    /// `true` when [`Self::check`] fails: what else is read is of no use.
    pub(crate) fn is_failed(&self) -> bool {
        let state = self.state.lock();
        state.failure.is_some() || (state.n_damages > 0 && state.access == Access::Writing)
    }

    /// Calls the observer, which may make the operation fail.
    pub(crate) fn observe(&self, change: &FileOperation<'_>) -> io::Result<()> {
        self.state
            .lock()
            .observer
            .as_mut()
            .map_or(Ok(()), |observer| observer(change))
    }

    /// Installs a hook for all further operations.
    pub(crate) fn set_observer(&self, observer: Observer) {
        self.state.lock().observer = Some(observer);
    }
}
