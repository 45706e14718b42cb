//! Reading files and folders no further than a limit.

use std::fmt;
use std::fs::{DirEntry, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Most names taken from one folder.
const MAX_NAMES: usize = 1 << 20;

/// Why a file or folder could not be read or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum FileError {
    /// The operating system refused.
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried: "read", "create" …
        action: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// A file is larger than its format can sensibly be.
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The most bytes that are read.
        limit: u64,
    },
    /// The path leads to a folder, device or pipe.
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// A folder has more entries than are read.
    TooManyEntries {
        /// The folder.
        path: PathBuf,
    },
    /// A file name is not text.
    NameNotText {
        /// The file.
        path: PathBuf,
    },
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io {
                path,
                action,
                source,
            } => {
                write!(f, "could not {action} {}: {source}", path.display())
            }
            Self::TooLarge { path, limit } => write!(
                f,
                "the file {} is larger than the limit of {limit} bytes; make it smaller",
                path.display()
            ),
            Self::NotAFile { path } => {
                write!(f, "{} is not a regular file; name a file", path.display())
            }
            Self::TooManyEntries { path } => write!(
                f,
                "the folder {} has more than {MAX_NAMES} entries; split it",
                path.display()
            ),
            Self::NameNotText { path } => {
                write!(
                    f,
                    "the name of {} is not UTF-8 text; rename the file",
                    path.display()
                )
            }
        }
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl FileError {
    /// Wraps what the system said about a path.
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            action,
            source,
        }
    }
}

/// Replaces the buffer's content by that of a regular file of at most `limit`
/// bytes. The buffer's memory is reused.
pub(crate) fn read_file(path: &Path, limit: u64, buffer: &mut Vec<u8>) -> Result<(), FileError> {
    let (file, size) = open_file(path)?;
    if size > limit {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
            limit,
        });
    }
    buffer.clear();
    buffer.reserve(size as usize);
    // The file may grow while it is read; one byte more shows that it did.
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

/// Opens a regular file and tells its size. A pipe would block for ever, so
/// the kind is looked at before the file is opened.
pub(crate) fn open_file(path: &Path) -> Result<(File, u64), FileError> {
    let metadata = path.metadata().map_err(FileError::io(path, "read"))?;
    if !metadata.is_file() {
        return Err(FileError::NotAFile {
            path: path.to_owned(),
        });
    }
    let file = File::open(path).map_err(FileError::io(path, "read"))?;
    Ok((file, metadata.len()))
}

/// The names of the files of a folder that `wanted` picks, in natural order.
pub(crate) fn file_names(
    folder: &Path,
    wanted: impl Fn(&str) -> bool,
) -> Result<Vec<String>, FileError> {
    entry_names(folder, |name, _| wanted(name))
}

/// The names of the folders in a folder, in natural order.
pub(crate) fn folder_names(folder: &Path) -> Result<Vec<String>, FileError> {
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
