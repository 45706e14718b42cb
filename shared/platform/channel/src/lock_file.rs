//! Locks that end with their process, whatever ends it.

use crate::Error;
use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// An open lock file; the lock is released when it is dropped.
#[derive(Debug)]
pub(crate) struct LockFile {
    file: File,
    path: PathBuf,
}

impl LockFile {
    /// Takes the lock alone; `None` when somebody holds it.
    pub(crate) fn try_exclusive(path: &Path) -> Result<Option<Self>, Error> {
        loop {
            let lock = Self::open(path)?;
            match lock.file.try_lock() {
                Ok(()) if lock.is_current() => return Ok(Some(lock)),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(source)) => return Err(lock.failed("lock", source)),
            }
        }
    }

    /// Takes the lock beside others; waits while somebody holds it alone.
    pub(crate) fn shared(path: &Path) -> Result<Self, Error> {
        loop {
            let lock = Self::open(path)?;
            lock.file
                .lock_shared()
                .map_err(|source| lock.failed("lock", source))?;
            if lock.is_current() {
                return Ok(lock);
            }
        }
    }

    /// Shares a lock that was held alone.
    pub(crate) fn share(&self) -> Result<(), Error> {
        self.file
            .lock_shared()
            .map_err(|source| self.failed("share the lock", source))
    }

    /// Whether nobody else holds the lock, which then is held alone.
    pub(crate) fn become_exclusive(&self) -> bool {
        self.file.try_lock().is_ok()
    }

    /// Writes this process's id into the file.
    pub(crate) fn write_pid(&mut self) -> Result<(), Error> {
        let write = |file: &mut File| {
            file.set_len(0)?;
            file.rewind()?;
            write!(file, "{}", std::process::id())
        };
        write(&mut self.file).map_err(|source| self.failed("write", source))
    }

    /// The process id in a lock file.
    pub(crate) fn read_pid(path: &Path) -> Option<u32> {
        let mut digits = String::new();
        File::open(path)
            .ok()?
            .take(16)
            .read_to_string(&mut digits)
            .ok()?;
        digits.trim().parse().ok()
    }

    fn open(path: &Path) -> Result<Self, Error> {
        let file = File::options()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        let source = match file {
            Ok(file) => {
                return Ok(Self {
                    file,
                    path: path.to_owned(),
                });
            }
            Err(source) => source,
        };
        Err(Error::RunFolder {
            attempt: "open the lock file",
            path: path.to_owned(),
            source,
        })
    }

    /// Whether the path still names the locked file: the last holder removes it,
    /// and a lock on a removed file excludes nobody.
    fn is_current(&self) -> bool {
        let by_path = std::fs::metadata(&self.path).map(|file| file.ino());
        let by_handle = self.file.metadata().map(|file| file.ino());
        matches!((by_path, by_handle), (Ok(a), Ok(b)) if a == b)
    }

    fn failed(&self, attempt: &'static str, source: std::io::Error) -> Error {
        Error::RunFolder {
            attempt,
            path: self.path.clone(),
            source,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_exclusive_or_many_shared() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.lock");
        let mut first = LockFile::try_exclusive(&path).unwrap().unwrap();
        first.write_pid().unwrap();
        assert!(LockFile::try_exclusive(&path).unwrap().is_none());
        assert_eq!(LockFile::read_pid(&path), Some(std::process::id()));
        first.share().unwrap();
        let second = LockFile::shared(&path).unwrap();
        assert!(!first.become_exclusive());
        drop(second);
        assert!(first.become_exclusive());
    }

    #[test]
    fn a_removed_lock_file_is_made_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.lock");
        let old = LockFile::try_exclusive(&path).unwrap().unwrap();
        std::fs::remove_file(&path).unwrap();
        let new = LockFile::try_exclusive(&path).unwrap();
        assert!(new.is_some() && !old.is_current());
    }
}
