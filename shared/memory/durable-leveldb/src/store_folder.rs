//! Store folder: file layout, advisory lock, and replacement of the database.
//!
//! ```text
//! lock                  locked while the store is open
//! database/             rusty-leveldb
//! database.damaged-1/   set aside, never modified again; the two newest are kept
//! database.rebuilding/  incomplete copy; removed when the store is opened
//! database.rebuilt/     complete copy that is about to replace the database
//! ```
//!
//! Other files in the folder belong to its owner and are left alone.

use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use crate::database::{Database, WRITE_BUFFER_BYTES};
use crate::durable_env::sync_folder;
use crate::error::Error;
use crate::log_file::LOG;

/// Name prefix of databases that were set aside.
const DAMAGED: &str = "database.damaged-";

/// Number of databases that were set aside and are kept.
pub const MAX_DAMAGED: usize = 2;

/// Name prefix of copies that earlier versions made for long reads.
const CHECKPOINT: &str = "checkpoint-";

/// Locked store folder; dropping it releases the lock.
pub struct StoreFolder {
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
    /// [`Error::InUse`] when another process, or another part of this one, has it.
    pub fn hold(path: &Path) -> Result<Self, Error> {
        fs::create_dir_all(path).map_err(Error::io("creating", path))?;
        // Absolute, so that a later change of the working directory has no effect.
        let path = path.canonicalize().map_err(Error::io("finding", path))?;
        if let Some(parent) = path.parent() {
            sync_folder(parent).map_err(Error::io("syncing the folder", parent))?;
        }
        let lock_path = path.join("lock");
        let lock = File::create(&lock_path).map_err(Error::io("creating", &lock_path))?;
        Self::locked(path, lock)
    }

    fn locked(path: PathBuf, lock: File) -> Result<Self, Error> {
        match lock.try_lock() {
            Ok(()) => Ok(Self {
                path,
                write_buffer_bytes: WRITE_BUFFER_BYTES,
                lock,
            }),
            Err(TryLockError::WouldBlock) => Err(Error::InUse { folder: path }),
            Err(TryLockError::Error(error)) => Err(Error::io("locking", path.join("lock"))(error)),
        }
    }

    /// Locks an existing store folder that need not be writable.
    ///
    /// # Errors
    ///
    /// As [`Self::hold`], and [`Error::Io`] when there is no store in it.
    pub fn hold_for_reading(path: &Path) -> Result<Self, Error> {
        let path = path.canonicalize().map_err(Error::io("finding", path))?;
        let lock_path = path.join("lock");
        let lock = File::open(&lock_path).map_err(Error::io("opening", &lock_path))?;
        Self::locked(path, lock)
    }

    /// Locks an existing store folder.
    ///
    /// # Errors
    ///
    /// As [`Self::hold`], and [`Error::Io`] when there is no store in it.
    pub fn hold_existing(path: &Path) -> Result<Self, Error> {
        let database = path.join("database");
        fs::metadata(&database).map_err(Error::io("finding", database))?;
        Self::hold(path)
    }

    /// Sets the size of the database's write buffer, bytes.
    pub fn with_write_buffer(mut self, write_buffer_bytes: usize) -> Self {
        self.write_buffer_bytes = write_buffer_bytes;
        self
    }

    /// Opens or creates the database; see [`Database::open`].
    ///
    /// # Errors
    ///
    /// As there.
    pub fn open_database(&self) -> Result<Database, Error> {
        Database::open(&self.database(), self.write_buffer_bytes)
    }

    /// Creates the database for a rebuild.
    ///
    /// # Errors
    ///
    /// As [`Database::open`].
    pub fn open_rebuilding(&self) -> Result<Database, Error> {
        Database::open(&self.rebuilding(), self.write_buffer_bytes)
    }

    /// Absolute path of the store folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of the database in the store folder.
    pub fn database(&self) -> PathBuf {
        self.path.join("database")
    }

    fn rebuilding(&self) -> PathBuf {
        self.path.join("database.rebuilding")
    }

    fn rebuilt(&self) -> PathBuf {
        self.path.join("database.rebuilt")
    }

    /// Removes incomplete copies of an earlier process, and copies that earlier versions made for
    /// long reads; finishes an interrupted replacement.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when something cannot be listed, removed or renamed.
    pub fn clean_up(&self) -> Result<(), Error> {
        let entries = fs::read_dir(&self.path).map_err(Error::io("listing", &self.path))?;
        for entry in entries.flatten() {
            let is_checkpoint = entry.file_name().to_string_lossy().starts_with(CHECKPOINT);
            if is_checkpoint && entry.path().is_dir() {
                let path = entry.path();
                fs::remove_dir_all(&path).map_err(Error::io("removing", path))?;
            }
        }

        let half = self.rebuilding();
        if half.exists() {
            fs::remove_dir_all(&half).map_err(Error::io("removing", half))?;
        }
        if self.rebuilt().exists() {
            self.put_rebuilt_in_place()?;
        }
        Ok(())
    }

    /// Replaces the database by the rebuilt copy; returns the path of the old database.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when something cannot be renamed.
    pub fn replace_by_rebuilding(&self) -> Result<Option<PathBuf>, Error> {
        self.rename(&self.rebuilding(), &self.rebuilt())?;
        self.put_rebuilt_in_place()
    }

    fn put_rebuilt_in_place(&self) -> Result<Option<PathBuf>, Error> {
        let damaged = if self.database().exists() {
            Some(self.set_aside()?)
        } else {
            None
        };
        self.rename(&self.rebuilt(), &self.database())?;
        Ok(damaged)
    }

    /// Renames the database to `database.damaged-<n>` with the next number, and removes all but the
    /// [newest of these](MAX_DAMAGED); returns the new path.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the database cannot be renamed, or an older one cannot be removed.
    pub fn set_aside(&self) -> Result<PathBuf, Error> {
        let mut earlier = self.damaged()?;
        let next = earlier.last().map_or(1, |(n, _)| n + 1);
        let aside = self.path.join(format!("{DAMAGED}{next}"));
        self.rename(&self.database(), &aside)?;
        earlier.truncate((earlier.len() + 1).saturating_sub(MAX_DAMAGED));
        for (_, oldest) in earlier {
            fs::remove_dir_all(&oldest).map_err(Error::io("removing", oldest))?;
        }
        Ok(aside)
    }

    /// Databases that were set aside, with their numbers, oldest first.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be listed.
    pub fn damaged(&self) -> Result<Vec<(u64, PathBuf)>, Error> {
        let entries = fs::read_dir(&self.path).map_err(Error::io("listing", &self.path))?;
        let mut damaged = Vec::new();
        for entry in entries {
            let entry = entry.map_err(Error::io("listing", &self.path))?;
            let name = entry.file_name();
            let number = name.to_str().and_then(|name| name.strip_prefix(DAMAGED));
            if let Some(number) = number.and_then(|number| number.parse().ok()) {
                damaged.push((number, entry.path()));
            }
        }
        damaged.sort_unstable();
        Ok(damaged)
    }

    /// `true` if the database has data but no CURRENT file. rusty-leveldb would create a new
    /// database over it and delete it.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder of the database cannot be listed.
    pub fn database_is_headless(&self) -> Result<bool, Error> {
        let database = self.database();
        let has_head = database.join("CURRENT").exists();
        Ok(!has_head && has_files(&database, &["ldb", "log", LOG])?)
    }

    /// `true` if the folder of the database has a table, whatever its manifest says.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder of the database cannot be listed.
    pub fn database_has_tables(&self) -> Result<bool, Error> {
        has_files(&self.database(), &["ldb", "sst"])
    }

    fn rename(&self, from: &Path, to: &Path) -> Result<(), Error> {
        fs::rename(from, to).map_err(Error::io("renaming", from))?;
        sync_folder(&self.path).map_err(Error::io("syncing the folder", &self.path))
    }
}

/// `true` if a folder exists and has a file with one of some extensions.
fn has_files(folder: &Path, extensions: &[&str]) -> Result<bool, Error> {
    if !folder.exists() {
        return Ok(false);
    }
    let entries = fs::read_dir(folder).map_err(Error::io("listing", folder))?;
    let is_wanted = |path: PathBuf| {
        let extension = path.extension().and_then(OsStr::to_str);
        extension.is_some_and(|extension| extensions.contains(&extension))
    };
    Ok(entries.flatten().any(|entry| is_wanted(entry.path())))
}
