//! The environment that makes rusty-leveldb durable.
//!
//! rusty-leveldb calls `flush` where C++ LevelDB syncs, and syncs nothing. Here
//! `flush` is `fdatasync`, a file that still has unsynced bytes is synced when it
//! is closed, and the folder is synced when a name in it appears or changes. A
//! synced write to the database is then exactly one `fdatasync`.
//!
//! A power cut keeps what was synced and any part of the rest; so the order
//! create, sync folder, write, sync file, rename, sync folder is what counts.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rusty_leveldb::env::{Env, FileLock, Logger, RandomAccess};
use rusty_leveldb::{PosixDiskEnv, Result};

use crate::env_health::{Change, EnvHealth};
use crate::verified_files::{VerifiedTable, check_log};

/// Length of a table's footer: a shorter table file cannot be one, and
/// rusty-leveldb subtracts it without looking.
const MIN_TABLE_BYTES: usize = 48;

/// The disk, durable and watched by an [`EnvHealth`].
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
            // Diagnosis for people: not worth a sync, and no reason to stop when it fails.
            return Ok(Box::new(options.open(path)?));
        }
        let file = self
            .health
            .change("creating", path, &Change::Create(path), || {
                options.open(path)
            })?;
        self.health.keep_created(path);
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

    /// Passes a reading's result on after the health has seen its error.
    fn noted<T>(&self, path: &Path, read: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &read {
            self.health.note_read_error(path, error);
        }
        read
    }

    fn sync_folder_of(&self, path: &Path) -> io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let change = Change::SyncFolder(folder);
        self.health
            .change("syncing the folder", folder, &change, || {
                sync_folder(folder)
            })
    }
}

/// Makes the names in a folder durable.
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
    /// The whole file at once: rusty-leveldb takes a short read for the end.
    fn open_sequential_file(&self, path: &Path) -> Result<Box<dyn Read>> {
        let is_current = path.file_name() == Some(OsStr::new("CURRENT"));
        let bytes = match fs::read(path) {
            // How a new database is told.
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
        let table = VerifiedTable::open(path, Arc::clone(&self.health));
        Ok(Box::new(self.noted(path, table)?))
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
        Ok(self.noted(path, fs::exists(path))?)
    }

    /// Without names that are not UTF-8, on which rusty-leveldb would panic; none is ours.
    fn children(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
        let entries = self.noted(folder, entries)?;
        let names = entries
            .into_iter()
            .filter_map(|entry| entry.file_name().into_string().ok());
        Ok(names.map(PathBuf::from).collect())
    }

    fn size_of(&self, path: &Path) -> Result<usize> {
        let size = self.noted(path, fs::metadata(path))?.len() as usize;
        if is_table(path) && size < MIN_TABLE_BYTES {
            let error = io::Error::new(io::ErrorKind::InvalidData, "it is too short for a table");
            self.health.note_read_error(path, &error);
            return Err(error.into());
        }
        Ok(size)
    }

    fn delete(&self, path: &Path) -> Result<()> {
        if self.health.holds_deletion(path) {
            return Ok(());
        }
        let change = Change::Delete(path);
        Ok(self
            .health
            .change("deleting", path, &change, || fs::remove_file(path))?)
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
        let change = Change::Rename(old, new);
        self.health
            .change("renaming", old, &change, || fs::rename(old, new))?;
        self.health.keep_created(new);
        Ok(self.sync_folder_of(new)?)
    }

    fn lock(&self, path: &Path) -> Result<FileLock> {
        // Asked first, since the lock's own error no longer says why.
        let change = Change::Create(path);
        self.health.change("locking", path, &change, || {
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

/// A file whose `flush` is `fdatasync`.
struct SyncedFile {
    file: File,
    path: PathBuf,
    is_dirty: bool,
    health: Arc<EnvHealth>,
}

impl Write for SyncedFile {
    /// All or an error: rusty-leveldb does not look at how much was written.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let change = Change::Write(&self.path, bytes);
        self.is_dirty = true;
        self.health.change("writing", &self.path, &change, || {
            self.file.write_all(bytes)
        })?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if !self.is_dirty {
            return Ok(());
        }
        let change = Change::Sync(&self.path);
        self.health
            .change("syncing", &self.path, &change, || self.file.sync_data())?;
        self.is_dirty = false;
        Ok(())
    }
}

impl Drop for SyncedFile {
    /// The health keeps the error, and so refuses the change that relies on this file.
    fn drop(&mut self) {
        let _ = self.flush();
    }
}
