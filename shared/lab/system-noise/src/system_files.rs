//! Reader of the kernel's files in `/proc` and `/sys`.

use std::path::{Path, PathBuf};

/// Root folder of `/proc` and `/sys`: the real root, or that of a test.
#[derive(Debug, Clone)]
pub(crate) struct SystemFiles {
    root: PathBuf,
}

impl SystemFiles {
    /// System files (`/proc`, `/sys`) of this computer.
    pub(crate) fn real() -> Self {
        Self::below(Path::new("/"))
    }

    /// System files below another root folder, for tests.
    pub(crate) fn below(root: &Path) -> Self {
        Self {
            root: root.to_owned(),
        }
    }

    /// Trimmed text of a file; `None` if it is unreadable, not UTF-8, or empty.
    pub(crate) fn text(&self, path: &str) -> Option<String> {
        let text = std::fs::read_to_string(self.root.join(path)).ok()?;
        let text = text.trim();
        (!text.is_empty()).then(|| text.to_owned())
    }

    /// Reads a number from a system file.
    pub(crate) fn number(&self, path: &str) -> Option<u64> {
        self.text(path)?.parse().ok()
    }

    /// `true` if the system file exists.
    pub(crate) fn has(&self, path: &str) -> bool {
        self.root.join(path).exists()
    }

    /// Sorted names in a folder; empty if it is unreadable.
    pub(crate) fn names_in(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.root.join(folder));
        let entries = entries.into_iter().flatten().flatten();
        let mut names: Vec<String> = entries
            .filter_map(|entry| entry.file_name().into_string().ok())
            .collect();
        names.sort();
        names
    }
}
