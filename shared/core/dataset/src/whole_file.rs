//! Writing files that are there whole or not at all.

use crate::FileError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Writes a file under a name that ends in `.part` and then gives it its own,
/// so that a writer that is killed leaves no half file behind that name.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let part = part_path(path);
    std::fs::write(&part, bytes).map_err(FileError::io(path, "write"))?;
    std::fs::rename(&part, path).map_err(FileError::io(path, "write"))
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
    fn only_the_whole_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file.png");
        for content in [&b"first"[..], b"2"] {
            write_whole(&path, content).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), content);
        }
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_whole(&folder.path().join("missing/file"), b"").unwrap_err();
        assert!(error.to_string().contains("missing/file"), "{error}");
    }
}
