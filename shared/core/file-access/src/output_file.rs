//! Atomic output file: a temporary file beside its target, and a rename. The one writer of all
//! files that a user names.

use crate::FileError;
use std::fs::{File, FileType, Permissions};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Permissions of a file for everybody whom the umask allows.
const SHARED: u32 = 0o666;
/// Permissions of a file for its user only.
const PRIVATE: u32 = 0o600;

/// Atomic output file: it gets its name when it is complete. Until then an existing file stays as
/// it is; a writer that is killed leaves a hidden file whose name ends in `.part`.
///
/// Only a regular file is ever replaced. A device, pipe, socket or folder is refused, and so is a
/// symbolic link: a rename would replace the link itself, and to follow it would write a file that
/// nobody has named.
#[derive(Debug)]
pub struct OutputFile {
    partial: NamedTempFile,
    target: PathBuf,
}

impl OutputFile {
    /// Begins a file that everybody may read whom the umask allows.
    ///
    /// # Errors
    /// When the target exists and is no regular file, or its folder cannot be written.
    pub fn create(target: &Path) -> Result<Self, FileError> {
        Self::with_permissions(target, SHARED)
    }

    /// Begins a file that only its user may read.
    ///
    /// # Errors
    /// As [`OutputFile::create`].
    pub fn create_private(target: &Path) -> Result<Self, FileError> {
        Self::with_permissions(target, PRIVATE)
    }

    fn with_permissions(target: &Path, mode: u32) -> Result<Self, FileError> {
        check_output(target)?;
        let partial = tempfile::Builder::new()
            .prefix(".tabula-")
            .suffix(".part")
            .permissions(Permissions::from_mode(mode))
            .tempfile_in(folder_of(target))
            .map_err(FileError::io(target, "write"))?;
        Ok(Self {
            partial,
            target: target.to_owned(),
        })
    }

    /// Gives the complete file its name, when it is on disk.
    ///
    /// # Errors
    /// When the target is by now no regular file, or the disk cannot be written; the target is
    /// then as it was.
    pub fn finish(self) -> Result<(), FileError> {
        let synced = self.partial.as_file().sync_all();
        synced.map_err(FileError::io(&self.target, "write"))?;
        let target = self.give_name()?;
        let synced = File::open(folder_of(&target)).and_then(|folder| folder.sync_all());
        synced.map_err(FileError::io(&target, "write"))
    }

    /// Gives the file its name, and returns that.
    fn give_name(self) -> Result<PathBuf, FileError> {
        let Self { partial, target } = self;
        check_output(&target)?;
        let named = partial.persist(&target).map_err(|failed| failed.error);
        named.map_err(FileError::io(&target, "write"))?;
        Ok(target)
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.partial.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.partial.flush()
    }
}

/// Writes a file as an [`OutputFile`]. The data is not synchronised to disk: after a power loss
/// the new file may be incomplete.
///
/// # Errors
/// When the target exists and is no regular file, or cannot be written; the error names it.
pub fn write_atomic(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), FileError> {
    let mut file = OutputFile::create(path)?;
    let written = file.write_all(bytes.as_ref());
    written.map_err(FileError::io(path, "write"))?;
    file.give_name().map(drop)
}

/// Checks that a name is free, or that of a regular file, which may be replaced.
///
/// # Errors
/// When something else has the name; the sentence says what it is.
pub fn check_output(path: &Path) -> Result<(), FileError> {
    let existing = match path.symlink_metadata() {
        Ok(metadata) => metadata.file_type(),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(FileError::io(path, "write")(error)),
    };
    if existing.is_file() {
        return Ok(());
    }
    let path = path.to_owned();
    Err(match path.read_link() {
        Ok(leads_to) => FileError::OutputIsLink { path, leads_to },
        Err(_) => FileError::OutputIsNoFile {
            path,
            kind: kind_name(existing),
        },
    })
}

fn kind_name(kind: FileType) -> &'static str {
    if kind.is_dir() {
        "folder"
    } else if kind.is_fifo() {
        "named pipe"
    } else if kind.is_socket() {
        "socket"
    } else {
        "device"
    }
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    folder.unwrap_or(Path::new("."))
}

/// Creates a folder and its parents; an existing folder is left as it is.
///
/// # Errors
/// When a folder cannot be created; the error names it.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(path).map_err(FileError::io(path, "create"))
}

#[cfg(test)]
mod tests;
