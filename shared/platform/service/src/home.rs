//! Home folder of a daemon's persistent data.

use channel::DomainName;
use std::path::{Path, PathBuf};

/// Folder of a daemon's persistent data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Home(PathBuf);

impl Home {
    /// Data folder at a given path.
    pub fn at(folder: PathBuf) -> Self {
        Self(folder)
    }

    /// Default home folder: the state folder given by systemd, otherwise a folder in
    /// the user's data folder, one for each domain.
    pub fn default_for(domain: &DomainName) -> Self {
        let folder = |name: &str| {
            std::env::var_os(name)
                .map(PathBuf::from)
                .filter(|path| path.is_absolute())
        };
        if let Some(state) = folder("STATE_DIRECTORY") {
            return Self(state);
        }
        let data = folder("XDG_DATA_HOME")
            .or_else(|| folder("HOME").map(|home| home.join(".local/share")))
            .unwrap_or_else(|| PathBuf::from("/var/lib"));
        Self(data.join("tabula").join(domain.to_string()))
    }

    /// Path of the data folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Folder of the perceptual memory's database.
    pub fn perceptual_memory(&self) -> PathBuf {
        self.0.join("perceptual-memory")
    }

    /// Folder of the working memory's database.
    pub fn working_memory(&self) -> PathBuf {
        self.0.join("working-memory")
    }
}
