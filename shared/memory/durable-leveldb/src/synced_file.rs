//! Writable file that is synced by `flush` and when it is closed.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::durable_env::sync_folder_of;
use crate::env_health::{EnvHealth, FileOperation};

/// Number of bytes after which a file is synced while it is written. The sync of another file waits
/// for these: with tables of eight megabytes synced at once, a teacher waited 12 ms at the 99th
/// percentile instead of 7. Measured with the bench `stalls` of `perceptual-memory`.
const MAX_UNSYNCED_BYTES: usize = 1 << 20;

/// File whose `flush` is `fdatasync`. A failed operation is recorded by the health monitor.
pub(crate) struct SyncedFile {
    file: File,
    path: PathBuf,
    /// Number of bytes written since the last sync.
    n_unsynced: usize,
    health: Arc<EnvHealth>,
}

impl SyncedFile {
    /// Creates or opens a file. Its name is durable only after a sync of the folder.
    pub(crate) fn open(
        path: &Path,
        options: &OpenOptions,
        health: &Arc<EnvHealth>,
    ) -> io::Result<Self> {
        let change = FileOperation::Create(path);
        let file = health.perform("creating", path, &change, || options.open(path))?;
        Ok(Self {
            file,
            path: path.to_owned(),
            n_unsynced: 0,
            health: Arc::clone(health),
        })
    }

    /// Creates a file that must not exist, and makes its name durable.
    pub(crate) fn create_new(path: &Path, health: &Arc<EnvHealth>) -> io::Result<Self> {
        let file = Self::open(
            path,
            OpenOptions::new().create_new(true).write(true),
            health,
        )?;
        sync_folder_of(path, health)?;
        Ok(file)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Write for SyncedFile {
    /// Writes all bytes or fails, since rusty-leveldb ignores the number of written bytes.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let change = FileOperation::Write(&self.path, bytes);
        self.health.perform("writing", &self.path, &change, || {
            self.file.write_all(bytes)
        })?;
        self.n_unsynced += bytes.len();
        if self.n_unsynced >= MAX_UNSYNCED_BYTES {
            self.flush()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.n_unsynced == 0 {
            return Ok(());
        }
        let change = FileOperation::Sync(&self.path);
        self.health
            .perform("syncing", &self.path, &change, || self.file.sync_data())?;
        self.n_unsynced = 0;
        Ok(())
    }
}

impl Drop for SyncedFile {
    /// Syncs the file. The health monitor keeps an error and so refuses the next change.
    fn drop(&mut self) {
        let _ = self.flush();
    }
}
