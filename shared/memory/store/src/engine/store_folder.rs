//! Store folder: file layout, advisory lock, and replacement of the database.
//!
//! ```text
//! lock                  locked while the store is open
//! acknowledged          the watermark
//! database/             rusty-leveldb
//! database.damaged-1/   set aside, never modified again
//! database.rebuilding/  incomplete copy; removed when the store is opened
//! database.rebuilt/     complete copy that is about to replace the database
//! checkpoint-1/         copy of the database for a long read; removed after it, or
//!                       when the store is opened
//! ```

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use crate::engine::database::{Database, WRITE_BUFFER_BYTES};
use crate::engine::durable_env::sync_folder;
use crate::engine::storage_error::StorageError;

/// Name prefix of checkpoint folders.
const CHECKPOINT: &str = "checkpoint-";

/// Locked store folder; dropping it releases the lock.
pub(crate) struct StoreFolder {
    path: PathBuf,
    write_buffer_bytes: usize,
    /// Lock file; the kernel releases the lock when the process ends.
    lock: File,
}

impl Drop for StoreFolder {
    /// Releases the lock. Closing the file is not enough, since a child process that is being
    /// started may have inherited it.
    fn drop(&mut self) {
        // An error here is harmless: closing the file follows.
        let _ = self.lock.unlock();
    }
}

impl StoreFolder {
    /// Creates the folder if it is missing, and locks it.
    ///
    /// # Errors
    ///
    /// [`StorageError::InUse`] when another process, or another part of this one, has it.
    pub(crate) fn hold(path: &Path) -> Result<Self, StorageError> {
        fs::create_dir_all(path).map_err(StorageError::io("creating", path))?;
        // Absolute, so that a later change of the working directory has no effect.
        let path = path
            .canonicalize()
            .map_err(StorageError::io("finding", path))?;
        if let Some(parent) = path.parent() {
            sync_folder(parent).map_err(StorageError::io("syncing the folder", parent))?;
        }
        let lock_path = path.join("lock");
        let lock = File::create(&lock_path).map_err(StorageError::io("creating", &lock_path))?;
        match lock.try_lock() {
            Ok(()) => Ok(Self {
                path,
                write_buffer_bytes: WRITE_BUFFER_BYTES,
                lock,
            }),
            Err(TryLockError::WouldBlock) => Err(StorageError::InUse { folder: path }),
            Err(TryLockError::Error(error)) => Err(StorageError::io("locking", lock_path)(error)),
        }
    }

    /// Locks an existing store folder.
    ///
    /// # Errors
    ///
    /// As [`Self::hold`], and [`Error::Io`] when there is no store in it.
    pub(crate) fn hold_existing(path: &Path) -> Result<Self, StorageError> {
        let database = path.join("database");
        fs::metadata(&database).map_err(StorageError::io("finding", database))?;
        Self::hold(path)
    }

    /// Sets the write-buffer size, bytes.
    pub(crate) fn with_write_buffer(mut self, write_buffer_bytes: usize) -> Self {
        self.write_buffer_bytes = write_buffer_bytes;
        self
    }

    /// Opens or creates the database; see [`Database::open`].
    ///
    /// # Errors
    ///
    /// As there.
    pub(crate) fn open_database(&self) -> Result<Database, StorageError> {
        Database::open(&self.database(), self.write_buffer_bytes)
    }

    /// Creates the database for a rebuild.
    ///
    /// # Errors
    ///
    /// As [`Database::open`].
    pub(crate) fn open_rebuilding(&self) -> Result<Database, StorageError> {
        Database::open(&self.rebuilding(), self.write_buffer_bytes)
    }

    pub(crate) fn watermark(&self) -> PathBuf {
        self.path.join("acknowledged")
    }

    pub(crate) fn database(&self) -> PathBuf {
        self.path.join("database")
    }

    fn rebuilding(&self) -> PathBuf {
        self.path.join("database.rebuilding")
    }

    fn rebuilt(&self) -> PathBuf {
        self.path.join("database.rebuilt")
    }

    /// Removes checkpoints and incomplete copies of an earlier process, and finishes an interrupted
    /// replacement.
    pub(crate) fn clean_up(&self) -> Result<(), StorageError> {
        let entries = fs::read_dir(&self.path).map_err(StorageError::io("listing", &self.path))?;
        for entry in entries.flatten() {
            let is_checkpoint = entry.file_name().to_string_lossy().starts_with(CHECKPOINT);
            if is_checkpoint && entry.path().is_dir() {
                let path = entry.path();
                fs::remove_dir_all(&path).map_err(StorageError::io("removing", path))?;
            }
        }

        let half = self.rebuilding();
        if half.exists() {
            fs::remove_dir_all(&half).map_err(StorageError::io("removing", half))?;
        }
        if self.rebuilt().exists() {
            self.put_rebuilt_in_place()?;
        }
        Ok(())
    }

    /// Path of a new checkpoint folder.
    pub(crate) fn new_checkpoint(&self) -> PathBuf {
        let paths = (1_u64..).map(|n| self.path.join(format!("{CHECKPOINT}{n}")));
        let mut free = paths.filter(|path| !path.exists());
        free.next().unwrap_or_else(|| self.path.join(CHECKPOINT))
    }

    /// Replaces the database by the rebuilt copy; returns the path of the old database.
    pub(crate) fn replace_by_rebuilding(&self) -> Result<Option<PathBuf>, StorageError> {
        self.rename(&self.rebuilding(), &self.rebuilt())?;
        self.put_rebuilt_in_place()
    }

    fn put_rebuilt_in_place(&self) -> Result<Option<PathBuf>, StorageError> {
        let damaged = if self.database().exists() {
            Some(self.set_aside()?)
        } else {
            None
        };
        self.rename(&self.rebuilt(), &self.database())?;
        Ok(damaged)
    }

    /// Renames the database to the first free `database.damaged-<n>`; returns the new path.
    pub(crate) fn set_aside(&self) -> Result<PathBuf, StorageError> {
        let mut n = 1;
        let aside = loop {
            let path = self.path.join(format!("database.damaged-{n}"));
            if !path.exists() {
                break path;
            }
            n += 1;
        };
        self.rename(&self.database(), &aside)?;
        Ok(aside)
    }

    /// `true` if the database has data but no CURRENT file. rusty-leveldb would create a new
    /// database over it and delete it.
    pub(crate) fn database_is_headless(&self) -> Result<bool, StorageError> {
        let database = self.database();
        if !database.exists() || database.join("CURRENT").exists() {
            return Ok(false);
        }
        let entries = fs::read_dir(&database).map_err(StorageError::io("listing", &database))?;
        let is_data = |path: PathBuf| path.extension().is_some_and(|e| e == "ldb" || e == "log");
        Ok(entries.flatten().any(|entry| is_data(entry.path())))
    }

    fn rename(&self, from: &Path, to: &Path) -> Result<(), StorageError> {
        fs::rename(from, to).map_err(StorageError::io("renaming", from))?;
        sync_folder(&self.path).map_err(StorageError::io("syncing the folder", &self.path))
    }
}
