//! Size-limited reading of files and folders.

use std::fs::{DirEntry, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Maximum number of names taken from one folder.
const MAX_NAMES: usize = 1 << 20;

/// Error of reading or writing a file or folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// Error of the operating system.
    #[error("could not {action} {}: {source}", .path.display())]
    Io {
        /// Path of the file or folder that could not be accessed.
        path: PathBuf,
        /// Attempted action, such as `read` or `create`.
        action: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
    /// File larger than the limit of its format.
    #[error(
        "the file {} is larger than the limit of {limit} bytes; make it smaller",
        .path.display()
    )]
    TooLarge {
        /// Path of the oversized file.
        path: PathBuf,
        /// Size limit of the format, bytes.
        limit: u64,
    },
    /// Path that leads to a folder, device or pipe.
    #[error("{} is not a regular file; name a file", .path.display())]
    NotAFile {
        /// Path that is not a regular file.
        path: PathBuf,
    },
    /// Target of a writer that exists and is no regular file.
    #[error(
        "{} is a {kind}, which no file replaces; name another file",
        .path.display()
    )]
    OutputIsNoFile {
        /// Path that is no regular file.
        path: PathBuf,
        /// Kind of what is there, such as `folder`.
        kind: &'static str,
    },
    /// Target of a writer that is a symbolic link, dangling or not.
    #[error(
        "{} is a symbolic link to {}, which no file replaces; name the file itself",
        .path.display(),
        .leads_to.display()
    )]
    OutputIsLink {
        /// Path of the link.
        path: PathBuf,
        /// Path that the link holds.
        leads_to: PathBuf,
    },
    /// Folder with more entries than the limit.
    #[error(
        "the folder {} has more than {max_names} entries; split it",
        .path.display(),
        max_names = MAX_NAMES
    )]
    TooManyEntries {
        /// Path of the folder with too many entries.
        path: PathBuf,
    },
    /// File name that is not UTF-8.
    #[error("the name of {} is not UTF-8 text; rename the file", .path.display())]
    NameNotText {
        /// Path of the file whose name is not UTF-8.
        path: PathBuf,
    },
}

impl FileError {
    /// Wraps an I/O error with its path and action.
    pub fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            action,
            source,
        }
    }
}

/// Reads a regular file of at most `limit` bytes into a buffer, whose memory is reused.
///
/// # Errors
/// When the file cannot be read, is larger than the limit, or is no regular file.
pub fn read_file(path: &Path, limit: u64, buffer: &mut Vec<u8>) -> Result<(), FileError> {
    let (file, size) = open_file(path)?;
    if size > limit {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
            limit,
        });
    }
    buffer.clear();
    buffer.reserve(size as usize);
    // The file may grow while it is read; one extra byte reveals that.
    file.take(limit + 1)
        .read_to_end(buffer)
        .map_err(FileError::io(path, "read"))?;
    if buffer.len() as u64 > limit {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
            limit,
        });
    }
    Ok(())
}

/// Opens a regular file and returns its size. A pipe would block forever, so the file type is
/// checked first.
///
/// # Errors
/// When the file cannot be opened, or is no regular file.
pub fn open_file(path: &Path) -> Result<(File, u64), FileError> {
    let metadata = path.metadata().map_err(FileError::io(path, "read"))?;
    if !metadata.is_file() {
        return Err(FileError::NotAFile {
            path: path.to_owned(),
        });
    }
    let file = File::open(path).map_err(FileError::io(path, "read"))?;
    Ok((file, metadata.len()))
}

/// Names of the files of a folder that `wanted` accepts, in natural order.
///
/// # Errors
/// When the folder cannot be read, has too many entries, or has a name that is no text.
pub fn file_names(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Vec<String>, FileError> {
    entry_names(folder, |name, _| wanted(name))
}

/// Names of the subfolders of a folder, in natural order.
///
/// # Errors
/// As [`file_names`].
pub fn folder_names(folder: &Path) -> Result<Vec<String>, FileError> {
    entry_names(folder, |_, entry| match entry.file_type() {
        Ok(kind) if kind.is_symlink() => entry.path().is_dir(),
        Ok(kind) => kind.is_dir(),
        Err(_) => false,
    })
}

fn entry_names(
    folder: &Path,
    wanted: impl Fn(&str, &DirEntry) -> bool,
) -> Result<Vec<String>, FileError> {
    let mut names = Vec::new();
    for (n_seen, entry) in folder
        .read_dir()
        .map_err(FileError::io(folder, "list"))?
        .enumerate()
    {
        if n_seen == MAX_NAMES {
            return Err(FileError::TooManyEntries {
                path: folder.to_owned(),
            });
        }
        let entry = entry.map_err(FileError::io(folder, "list"))?;
        let Ok(name) = entry.file_name().into_string() else {
            return Err(FileError::NameNotText { path: entry.path() });
        };
        if wanted(&name, &entry) {
            names.push(name);
        }
    }
    names.sort_unstable_by(|left, right| crate::natural_order(left, right));
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, [7; 100]).unwrap();
        let mut buffer = vec![1; 5];
        read_file(&path, 100, &mut buffer).unwrap();
        assert_eq!(buffer, [7; 100]);
        assert!(matches!(
            read_file(&path, 99, &mut buffer),
            Err(FileError::TooLarge { .. })
        ));
        let not_a_file = read_file(folder.path(), 99, &mut buffer);
        assert!(matches!(not_a_file, Err(FileError::NotAFile { .. })));
        let missing = read_file(&folder.path().join("missing"), 99, &mut buffer).unwrap_err();
        assert!(missing.to_string().contains("could not read"), "{missing}");
    }

    #[test]
    fn an_endless_device_is_refused() {
        let mut buffer = Vec::new();
        let error = read_file(Path::new("/dev/zero"), 1 << 20, &mut buffer).unwrap_err();
        assert!(matches!(error, FileError::NotAFile { .. }), "{error}");
    }

    #[test]
    fn names_come_in_natural_order() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b10", "b2", "c1", "a3"] {
            std::fs::write(folder.path().join(name), []).unwrap();
        }
        let names = file_names(folder.path(), |name| name != "c1").unwrap();
        assert_eq!(names, ["a3", "b2", "b10"]);
    }
}
