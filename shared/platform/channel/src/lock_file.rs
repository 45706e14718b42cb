//! File locks (`flock`), which the kernel releases when their process ends in any
//! way.

use crate::Error;
use crate::trusted_folder::TrustedFolder;
use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::sync::Arc;

/// Open lock file; the lock is released on drop.
#[derive(Debug)]
pub(crate) struct LockFile {
    file: File,
    folder: Arc<TrustedFolder>,
    name: String,
}

impl LockFile {
    /// Takes the exclusive lock; `None` when another process holds the lock.
    pub(crate) fn try_exclusive(
        folder: &Arc<TrustedFolder>,
        name: &str,
    ) -> Result<Option<Self>, Error> {
        loop {
            let lock = Self::open(folder, name)?;
            match lock.file.try_lock() {
                Ok(()) if lock.is_current() => return Ok(Some(lock)),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(source)) => return Err(lock.failed("lock", source)),
            }
        }
    }

    /// Takes the shared lock; waits while another process holds it exclusively.
    pub(crate) fn shared(folder: &Arc<TrustedFolder>, name: &str) -> Result<Self, Error> {
        loop {
            let lock = Self::open(folder, name)?;
            lock.file
                .lock_shared()
                .map_err(|source| lock.failed("lock", source))?;
            if lock.is_current() {
                return Ok(lock);
            }
        }
    }

    /// Turns an exclusive lock into a shared one.
    pub(crate) fn share(&self) -> Result<(), Error> {
        self.file
            .lock_shared()
            .map_err(|source| self.failed("share the lock", source))
    }

    /// Turns a shared lock into an exclusive one; `false` when other processes hold
    /// it.
    pub(crate) fn become_exclusive(&self) -> bool {
        self.file.try_lock().is_ok()
    }

    /// Writes this process's id into the lock file.
    pub(crate) fn write_pid(&mut self) -> Result<(), Error> {
        let write = |file: &mut File| {
            file.set_len(0)?;
            file.rewind()?;
            write!(file, "{}", std::process::id())
        };
        write(&mut self.file).map_err(|source| self.failed("write", source))
    }

    /// Process id in a lock file; `None` when there is none.
    pub(crate) fn read_pid(folder: &TrustedFolder, name: &str) -> Option<u32> {
        let mut digits = String::new();
        let file = folder.open_file(name, false).ok()?;
        file.take(16).read_to_string(&mut digits).ok()?;
        digits.trim().parse().ok()
    }

    /// `true` while a living process holds the lock. A missing file is not created.
    pub(crate) fn is_held(folder: &TrustedFolder, name: &str) -> bool {
        let file = folder.open_file(name, false);
        file.is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
    }

    fn open(folder: &Arc<TrustedFolder>, name: &str) -> Result<Self, Error> {
        Ok(Self {
            file: folder.open_file(name, true)?,
            folder: folder.clone(),
            name: name.to_owned(),
        })
    }

    /// `true` while the name still denotes the locked file: the last holder removes
    /// it, and a lock on a removed file excludes no other process.
    pub(crate) fn is_current(&self) -> bool {
        self.folder.names(&self.name, &self.file)
    }

    fn failed(&self, attempt: &'static str, source: std::io::Error) -> Error {
        Error::RunFolder {
            attempt,
            path: self.folder.path().join(&self.name),
            source,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> (tempfile::TempDir, Arc<TrustedFolder>) {
        let guard = tempfile::tempdir().unwrap();
        let folder = TrustedFolder::open(guard.path()).unwrap();
        (guard, Arc::new(folder))
    }

    #[test]
    fn lock_is_exclusive_or_shared() {
        let (_guard, folder) = folder();
        let mut first = LockFile::try_exclusive(&folder, "x.lock").unwrap().unwrap();
        first.write_pid().unwrap();
        assert!(
            LockFile::try_exclusive(&folder, "x.lock")
                .unwrap()
                .is_none()
        );
        assert!(LockFile::is_held(&folder, "x.lock"));
        assert_eq!(
            LockFile::read_pid(&folder, "x.lock"),
            Some(std::process::id())
        );
        first.share().unwrap();
        let second = LockFile::shared(&folder, "x.lock").unwrap();
        assert!(!first.become_exclusive());
        drop(second);
        assert!(first.become_exclusive());
    }

    #[test]
    fn removed_lock_file_is_created_again() {
        let (guard, folder) = folder();
        let old = LockFile::try_exclusive(&folder, "x.lock").unwrap().unwrap();
        std::fs::remove_file(guard.path().join("x.lock")).unwrap();
        let new = LockFile::try_exclusive(&folder, "x.lock").unwrap();
        assert!(new.is_some() && !old.is_current());
    }

    #[test]
    fn looking_at_a_missing_lock_does_not_create_it() {
        let (guard, folder) = folder();
        assert!(!LockFile::is_held(&folder, "x.lock"));
        assert_eq!(LockFile::read_pid(&folder, "x.lock"), None);
        assert!(!guard.path().join("x.lock").exists());
    }
}
