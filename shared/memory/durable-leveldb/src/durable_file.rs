//! Durable file: written under a temporary name, synced, and renamed into place.
//!
//! The file appears under its name only whole. Its operations are seen by the [observer] of the
//! database, but their failure does not stop the database, which does not depend on it.
//!
//! [observer]: crate::Observer

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::durable_env::sync_folder;
use crate::env_health::{EnvHealth, FileOperation};
use crate::error::Error;

/// File that is being written; dropping it before [`Self::commit`] removes it.
pub struct DurableFile {
    file: File,
    path: PathBuf,
    health: Arc<EnvHealth>,
    is_committed: bool,
}

impl DurableFile {
    pub(crate) fn create(path: &Path, health: Arc<EnvHealth>) -> Result<Self, Error> {
        let partial = partial_path(path);
        let change = FileOperation::Create(&partial);
        let created = health.observe(&change);
        let file = created
            .and_then(|()| File::create(&partial))
            .map_err(Error::io("creating", &partial))?;
        Ok(Self {
            file,
            path: path.to_owned(),
            health,
            is_committed: false,
        })
    }

    /// Appends bytes; they are durable after [`Self::commit`].
    ///
    /// # Errors
    ///
    /// [`Error::Io`].
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let partial = partial_path(&self.path);
        self.health
            .observe(&FileOperation::Write(&partial, bytes))
            .and_then(|()| self.file.write_all(bytes))
            .map_err(Error::io("writing", partial))
    }

    /// Syncs what was written so far, so that the commit has less to sync.
    ///
    /// # Errors
    ///
    /// [`Error::Io`].
    pub fn sync(&mut self) -> Result<(), Error> {
        let partial = partial_path(&self.path);
        self.health
            .observe(&FileOperation::Sync(&partial))
            .and_then(|()| self.file.sync_data())
            .map_err(Error::io("syncing", partial))
    }

    /// Syncs the file, gives it its name, and syncs the folder. The file is durable on return.
    ///
    /// # Errors
    ///
    /// [`Error::Io`]; the file may be there or not, but never in part.
    pub fn commit(mut self) -> Result<(), Error> {
        self.sync()?;
        let partial = partial_path(&self.path);
        self.health
            .observe(&FileOperation::Rename(&partial, &self.path))
            .and_then(|()| fs::rename(&partial, &self.path))
            .map_err(Error::io("renaming", &partial))?;
        self.is_committed = true;
        let folder = self.path.parent().unwrap_or(Path::new("."));
        self.health
            .observe(&FileOperation::SyncFolder(folder))
            .and_then(|()| sync_folder(folder))
            .map_err(Error::io("syncing the folder", folder))
    }
}

impl Drop for DurableFile {
    fn drop(&mut self) {
        if !self.is_committed {
            // What remains is removed when the store is opened.
            let _ = fs::remove_file(partial_path(&self.path));
        }
    }
}

/// Name of the file until it is whole: its own with the suffix `.partial`.
fn partial_path(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".partial");
    PathBuf::from(name)
}
