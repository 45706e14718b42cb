//! Where a daemon keeps what must last.

use channel::DomainName;
use std::path::{Path, PathBuf};

/// The folder of a daemon's lasting data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Home(PathBuf);

impl Home {
    /// A given folder.
    pub fn at(folder: PathBuf) -> Self {
        Self(folder)
    }

    /// The state folder given by systemd, otherwise a folder of the user's own,
    /// one for each domain.
    pub fn of_user(domain: &DomainName) -> Self {
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

    /// The folder.
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
