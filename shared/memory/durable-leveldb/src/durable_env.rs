//! LevelDB environment (file-system layer) with real syncs, which rusty-leveldb lacks.
//!
//! rusty-leveldb calls `flush` where C++ LevelDB syncs, and syncs nothing. Here `flush` is
//! `fdatasync`, a file with unsynced bytes is synced when it is closed, and the folder is synced
//! when a name in it is added or changed. A synced write to the database is then exactly one
//! `fdatasync`.
//!
//! A power cut keeps all synced bytes and any part of the others. The order create, sync folder,
//! write, sync file, rename, sync folder is therefore essential.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rusty_leveldb::env::{Env, FileLock, Logger, RandomAccess};
use rusty_leveldb::{PosixDiskEnv, Result};

use crate::env_health::{EnvHealth, FileOperation};
use crate::read_retry::retried;
use crate::verified_files::{VerifiedTable, check_log};

/// Minimum length of a table file: its footer. rusty-leveldb subtracts the footer without checking.
const MIN_TABLE_BYTES: usize = 48;

/// Durable file system, monitored by an [`EnvHealth`].
pub(crate) struct DurableEnv {
    disk: PosixDiskEnv,
    health: Arc<EnvHealth>,
}

impl DurableEnv {
    pub(crate) fn new(health: Arc<EnvHealth>) -> Self {
        Self {
            disk: PosixDiskEnv::new(),
            health,
        }
    }

    fn create(&self, path: &Path, options: &OpenOptions) -> Result<Box<dyn Write>> {
        if is_info_log(path) {
            // Diagnostic log: needs no sync, and its failure is not fatal.
            return Ok(Box::new(options.open(path)?));
        }
        let file = self
            .health
            .perform("creating", path, &FileOperation::Create(path), || {
                options.open(path)
            })?;
        self.health.cancel_deferred_deletion(path);
        // A temporary file is renamed next, and the rename syncs the folder.
        if path.extension() != Some(OsStr::new("dbtmp")) {
            self.sync_folder_of(path)?;
        }
        let health = Arc::clone(&self.health);
        Ok(Box::new(SyncedFile {
            file,
            path: path.to_owned(),
            is_dirty: false,
            health,
        }))
    }

    /// Reports a read error to the health monitor and passes the result on.
    fn noted<T>(&self, path: &Path, read: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &read {
            self.health.note_read_error(path, error);
        }
        read
    }

    fn sync_folder_of(&self, path: &Path) -> io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let change = FileOperation::SyncFolder(folder);
        self.health
            .perform("syncing the folder", folder, &change, || {
                sync_folder(folder)
            })
    }
}

/// Syncs a folder, which makes its names durable.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

fn is_info_log(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name == "LOG" || name == "LOG.old")
}

fn is_table(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension == "ldb" || extension == "sst")
}

impl Env for DurableEnv {
    /// Reads the whole file at once, since rusty-leveldb takes a short read for the end.
    fn open_sequential_file(&self, path: &Path) -> Result<Box<dyn Read>> {
        let is_current = path.file_name() == Some(OsStr::new("CURRENT"));
        let read = retried(|| {
            self.health.observe(&FileOperation::Read(path))?;
            fs::read(path)
        });
        let bytes = match read {
            // The sign of a new database.
            Err(error) if is_current && error.kind() == io::ErrorKind::NotFound => {
                return Err(error.into());
            }
            read => self.noted(path, read)?,
        };
        if !is_current && let Some(damage) = check_log(&bytes) {
            self.health
                .note_damage(format!("{}: {damage}", path.display()));
        }
        Ok(Box::new(Cursor::new(bytes)))
    }

    fn open_random_access_file(&self, path: &Path) -> Result<Box<dyn RandomAccess>> {
        let table = retried(|| VerifiedTable::open(path, Arc::clone(&self.health)));
        Ok(Box::new(self.noted(path, table)?))
    }

    fn open_writable_file(&self, path: &Path) -> Result<Box<dyn Write>> {
        // Of a volatile copy: a table that a crash left in the original, whose number is used
        // again. It must not be written through the link.
        if path.is_symlink() {
            fs::remove_file(path)?;
        }
        self.create(
            path,
            OpenOptions::new().create(true).truncate(true).write(true),
        )
    }

    fn open_appendable_file(&self, path: &Path) -> Result<Box<dyn Write>> {
        self.create(path, OpenOptions::new().create(true).append(true))
    }

    fn exists(&self, path: &Path) -> Result<bool> {
        Ok(self.noted(path, fs::exists(path))?)
    }

    /// File names in a folder, without names that are not UTF-8, on which rusty-leveldb would
    /// panic.
    fn children(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
        let entries = self.noted(folder, entries)?;
        let names = entries
            .into_iter()
            .filter_map(|entry| entry.file_name().into_string().ok());
        Ok(names.map(PathBuf::from).collect())
    }

    fn size_of(&self, path: &Path) -> Result<usize> {
        let size = retried(|| fs::metadata(path));
        let size = self.noted(path, size)?.len() as usize;
        if is_table(path) && size < MIN_TABLE_BYTES {
            let error = io::Error::new(io::ErrorKind::InvalidData, "it is too short for a table");
            self.health.note_read_error(path, &error);
            return Err(error.into());
        }
        Ok(size)
    }

    fn delete(&self, path: &Path) -> Result<()> {
        if self.health.defers_deletion(path) {
            return Ok(());
        }
        let change = FileOperation::Delete(path);
        Ok(self
            .health
            .perform("deleting", path, &change, || fs::remove_file(path))?)
    }

    fn mkdir(&self, path: &Path) -> Result<()> {
        self.disk.mkdir(path)?;
        Ok(self.sync_folder_of(path)?)
    }

    fn rmdir(&self, path: &Path) -> Result<()> {
        self.disk.rmdir(path)
    }

    fn rename(&self, old: &Path, new: &Path) -> Result<()> {
        if is_info_log(old) {
            return self.disk.rename(old, new);
        }
        let change = FileOperation::Rename(old, new);
        self.health
            .perform("renaming", old, &change, || fs::rename(old, new))?;
        self.health.cancel_deferred_deletion(new);
        Ok(self.sync_folder_of(new)?)
    }

    fn lock(&self, path: &Path) -> Result<FileLock> {
        // Opened first, since the error of the lock itself does not contain the cause.
        let change = FileOperation::Create(path);
        self.health.perform("locking", path, &change, || {
            OpenOptions::new()
                .create(true)
                .truncate(false)
                .write(true)
                .open(path)
        })?;
        self.disk.lock(path)
    }

    fn unlock(&self, lock: FileLock) -> Result<()> {
        self.disk.unlock(lock)
    }

    fn new_logger(&self, path: &Path) -> Result<Logger> {
        self.disk.new_logger(path)
    }

    fn micros(&self) -> u64 {
        self.disk.micros()
    }

    fn sleep_for(&self, micros: u32) {
        self.disk.sleep_for(micros);
    }
}

/// File whose `flush` is `fdatasync`.
struct SyncedFile {
    file: File,
    path: PathBuf,
    is_dirty: bool,
    health: Arc<EnvHealth>,
}

impl Write for SyncedFile {
    /// Writes all bytes or fails, since rusty-leveldb ignores the number of written bytes.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let change = FileOperation::Write(&self.path, bytes);
        self.is_dirty = true;
        self.health.perform("writing", &self.path, &change, || {
            self.file.write_all(bytes)
        })?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if !self.is_dirty {
            return Ok(());
        }
        let change = FileOperation::Sync(&self.path);
        self.health
            .perform("syncing", &self.path, &change, || self.file.sync_data())?;
        self.is_dirty = false;
        Ok(())
    }
}

impl Drop for SyncedFile {
    /// Syncs the file. The health monitor keeps an error and so refuses the next change.
    fn drop(&mut self) {
        let _ = self.flush();
    }
}
