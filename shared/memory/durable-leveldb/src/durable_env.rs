//! LevelDB environment (file-system layer) with real syncs, which rusty-leveldb lacks.
//!
//! rusty-leveldb calls `flush` where C++ LevelDB syncs, and syncs nothing. Here `flush` is
//! `fdatasync`, a file with unsynced bytes is synced when it is closed, and the folder is synced
//! when a name in it is added or changed. rusty-leveldb's own log is not written, and tables that it
//! deletes are only noted; see [`crate::engine`].
//!
//! A power cut keeps all synced bytes and any part of the others. The order create, sync folder,
//! write, sync file, rename, sync folder is therefore essential.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parking_lot::Mutex;
use rusty_leveldb::env::{Env, FileLock, Logger, RandomAccess};
use rusty_leveldb::{PosixDiskEnv, Result};

use crate::env_health::{EnvHealth, FileOperation};
use crate::read_retry::retried;
use crate::synced_file::SyncedFile;
use crate::table::delete;
use crate::verified_files::{VerifiedTable, read_file, read_log};

/// Minimum length of a table file: its footer. rusty-leveldb subtracts the footer without checking.
const MIN_TABLE_BYTES: usize = 48;

/// Durable file system, monitored by an [`EnvHealth`].
pub(crate) struct DurableEnv {
    disk: PosixDiskEnv,
    health: Arc<EnvHealth>,
    obsolete_tables: ObsoleteTables,
}

/// Tables that the engine no longer needs.
pub(crate) type ObsoleteTables = Arc<Mutex<Vec<PathBuf>>>;

impl DurableEnv {
    pub(crate) fn new(health: Arc<EnvHealth>, obsolete_tables: ObsoleteTables) -> Self {
        Self {
            disk: PosixDiskEnv::new(),
            health,
            obsolete_tables,
        }
    }

    fn create(&self, path: &Path, options: &OpenOptions) -> Result<Box<dyn Write>> {
        if is_info_log(path) {
            // Diagnostic log: needs no sync, and its failure is not fatal.
            return Ok(Box::new(options.open(path)?));
        }
        if has_extension(path, "log") {
            // What the engine is given is in the log of the [`Database`](crate::Database).
            return Ok(Box::new(io::sink()));
        }
        let file = SyncedFile::open(path, options, &self.health)?;
        // Numbers of tables that a crash left are used again.
        self.obsolete_tables.lock().retain(|table| table != path);
        // A temporary file is renamed next, and the rename syncs the folder.
        if !has_extension(path, "dbtmp") {
            sync_folder_of(path, &self.health)?;
        }
        Ok(Box::new(file))
    }
}

/// Syncs the folder of a file, which makes its name durable.
pub(crate) fn sync_folder_of(path: &Path, health: &EnvHealth) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let change = FileOperation::SyncFolder(folder);
    health.perform("syncing the folder", folder, &change, || {
        sync_folder(folder)
    })
}

/// Syncs a folder, which makes its names durable.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

fn is_info_log(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name == "LOG" || name == "LOG.old")
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension() == Some(OsStr::new(extension))
}

/// `true` for the path of a table.
fn is_table(path: &Path) -> bool {
    has_extension(path, "ldb") || has_extension(path, "sst")
}

impl Env for DurableEnv {
    /// Reads the whole file at once, since rusty-leveldb takes a short read for the end.
    fn open_sequential_file(&self, path: &Path) -> Result<Box<dyn Read>> {
        let is_current = path.file_name() == Some(OsStr::new("CURRENT"));
        if is_current && !path.exists() {
            // The sign of a new database.
            return Err(io::Error::from(io::ErrorKind::NotFound).into());
        }
        let read = if is_current { read_file } else { read_log };
        Ok(Box::new(Cursor::new(read(path, &self.health)?)))
    }

    fn open_random_access_file(&self, path: &Path) -> Result<Box<dyn RandomAccess>> {
        let table = VerifiedTable::open(path.into(), Arc::clone(&self.health));
        Ok(Box::new(table?))
    }

    fn open_writable_file(&self, path: &Path) -> Result<Box<dyn Write>> {
        self.create(
            path,
            OpenOptions::new().create(true).truncate(true).write(true),
        )
    }

    fn open_appendable_file(&self, path: &Path) -> Result<Box<dyn Write>> {
        self.create(path, OpenOptions::new().create(true).append(true))
    }

    fn exists(&self, path: &Path) -> Result<bool> {
        Ok(self.health.noted(path, fs::exists(path))?)
    }

    /// File names in a folder, without names that are not UTF-8, on which rusty-leveldb would
    /// panic.
    fn children(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
        let entries = self.health.noted(folder, entries)?;
        let names = entries
            .into_iter()
            .filter_map(|entry| entry.file_name().into_string().ok());
        Ok(names.map(PathBuf::from).collect())
    }

    fn size_of(&self, path: &Path) -> Result<usize> {
        let size = retried(|| fs::metadata(path));
        let size = self.health.noted(path, size)?.len() as usize;
        if is_table(path) && size < MIN_TABLE_BYTES {
            let error = io::Error::new(io::ErrorKind::InvalidData, "it is too short for a table");
            self.health.note_read_error(path, &error);
            return Err(error.into());
        }
        Ok(size)
    }

    /// Deletes a file; a table only later, since it may be read.
    fn delete(&self, path: &Path) -> Result<()> {
        if is_table(path) {
            self.obsolete_tables.lock().push(path.to_owned());
            return Ok(());
        }
        Ok(delete(path, &self.health)?)
    }

    fn mkdir(&self, path: &Path) -> Result<()> {
        self.disk.mkdir(path)?;
        Ok(sync_folder_of(path, &self.health)?)
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
        Ok(sync_folder_of(new, &self.health)?)
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
