//! Atomic file write: temporary file and rename.

use crate::FileError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Atomic file write: writes a temporary file next to the target and renames it over the target.
///
/// A writer that is killed leaves the old file or the new file, and perhaps the temporary file,
/// whose name ends in `.part`. The data is not synchronised to disk: after a power loss the new
/// file may be incomplete.
///
/// # Errors
/// When the file cannot be written or renamed; the error names the target.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let part = part_path(path);
    std::fs::write(&part, bytes).map_err(FileError::io(path, "write"))?;
    std::fs::rename(&part, path).map_err(FileError::io(path, "write"))
}

/// Creates a folder and its parents; an existing folder is left as it is.
///
/// # Errors
/// When a folder cannot be created; the error names it.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(path).map_err(FileError::io(path, "create"))
}

fn part_path(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".part");
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_temporary_file_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file.png");
        for content in [&b"first"[..], b"2"] {
            write_atomic(&path, content).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), content);
        }
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_atomic(&folder.path().join("missing/file"), b"").unwrap_err();
        assert!(error.to_string().contains("missing/file"), "{error}");
    }
}
