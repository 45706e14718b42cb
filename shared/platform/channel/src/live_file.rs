//! Live file: a small file in a domain's run folder that counts only while its writer lives.
//!
//! Each writing makes a new file, locks it, and renames it into place, so that a reader
//! sees one content or the next, never a part. The writer keeps the lock, which the kernel
//! releases however the writer ends: a content without a lock is that of a dead process,
//! and is ignored. A reader needs no more than permission to read.

use crate::trusted_folder::TrustedFolder;
use crate::{Domain, DomainName, Error, RunFolder};
use rustix::fs::{Mode, OFlags, fchmod};
use std::fs::{File, TryLockError};
use std::io::{Read, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::Path;

/// Largest content of a live file, bytes; a reader ignores a larger one.
const MAX_BYTES: u64 = 64 * 1024;
/// Attempts of a reader whose file is replaced meanwhile.
const MAX_ATTEMPTS: u32 = 10;

/// File of one writer, removed when the writer drops it.
#[derive(Debug)]
pub struct LiveFile {
    folder: TrustedFolder,
    name: String,
    current: Option<File>,
    _domain: Domain,
}

impl LiveFile {
    /// Prepares a file in the run folder of the domain. One process may write it at a time.
    ///
    /// # Errors
    /// When the run folder is not this user's.
    pub fn new(domain: &Domain, name: &str) -> Result<Self, Error> {
        Ok(Self {
            folder: TrustedFolder::open(domain.folder())?,
            name: name.to_owned(),
            current: None,
            _domain: domain.clone(),
        })
    }

    /// Replaces the content. The group of the control socket may read it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&mut self, content: &[u8]) -> Result<(), Error> {
        let draft = format!("{}.new", self.name);
        let failed = |source| Error::RunFolder {
            attempt: "write",
            path: self.folder.path().join(&draft),
            source,
        };
        // A new file, which nobody else has opened, so that nobody else holds its lock.
        self.folder.remove_file(&draft);
        let mut file = self.folder.open_file(&draft, true)?;
        file.try_lock().map_err(|error| failed(error.into()))?;
        file.write_all(content).map_err(failed)?;
        self.folder.share_entry_with_group(&draft);
        let readable_by_group = Mode::RUSR | Mode::WUSR | Mode::RGRP;
        fchmod(&file, readable_by_group).map_err(|error| failed(error.into()))?;
        self.folder.rename(&draft, &self.name)?;
        self.current = Some(file);
        Ok(())
    }

    /// Content of a domain's live file in the first of the run folders that has one;
    /// `None` when no living process has written it.
    pub fn read(domain: &DomainName, run_folders: &[RunFolder], name: &str) -> Option<Vec<u8>> {
        let read = |folder: &RunFolder| read_live(&folder.domain_folder(domain).join(name));
        run_folders.iter().find_map(read)
    }
}

impl Drop for LiveFile {
    fn drop(&mut self) {
        if let Some(file) = &self.current
            && self.folder.names(&self.name, file)
        {
            self.folder.remove_file(&self.name);
        }
    }
}

fn read_live(path: &Path) -> Option<Vec<u8>> {
    for _ in 0..MAX_ATTEMPTS {
        let file = File::options()
            .read(true)
            .custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed())
            .open(path)
            .ok()?;
        let opened = file.metadata().ok()?;
        if !opened.is_file() || opened.nlink() > 1 {
            return None;
        }
        let mut content = Vec::new();
        (&file).take(MAX_BYTES + 1).read_to_end(&mut content).ok()?;
        if matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)) {
            return (content.len() as u64 <= MAX_BYTES).then_some(content);
        }
        // Either its writer is dead, or has replaced the file since it was opened.
        let current = std::fs::symlink_metadata(path).ok()?;
        if (current.dev(), current.ino()) == (opened.dev(), opened.ino()) {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Role;

    struct Place {
        _guard: tempfile::TempDir,
        folders: [RunFolder; 1],
        name: DomainName,
    }

    fn place(number: u32) -> Place {
        let guard = tempfile::tempdir_in("/dev/shm").unwrap();
        Place {
            folders: [RunFolder::at(guard.path().join("tabula"))],
            _guard: guard,
            name: format!("live-{}-{number}", std::process::id())
                .parse()
                .unwrap(),
        }
    }

    #[test]
    fn live_file_is_read_while_its_writer_lives() {
        let place = place(0);
        let read = || LiveFile::read(&place.name, &place.folders, "state");
        assert_eq!(read(), None);
        let domain = Domain::join(&place.name, &place.folders[0], Role::Guest).unwrap();
        let mut file = LiveFile::new(&domain, "state").unwrap();
        assert_eq!(read(), None, "nothing was written");
        for content in [&b"a long first content"[..], b"second"] {
            file.write(content).unwrap();
            assert_eq!(read().as_deref(), Some(content));
        }
        drop(file);
        assert_eq!(read(), None);
    }

    #[test]
    fn live_file_of_a_dead_writer_is_ignored() {
        let place = place(1);
        let domain = Domain::join(&place.name, &place.folders[0], Role::Guest).unwrap();
        let path = domain.folder().join("state");
        std::fs::write(&path, "left by a crash").unwrap();
        let read = || LiveFile::read(&place.name, &place.folders, "state");
        assert_eq!(read(), None, "no process holds it");
        // A draft that a crash has left does not hinder the next writer.
        std::fs::write(domain.folder().join("state.new"), "left by a crash, too").unwrap();
        let mut file = LiveFile::new(&domain, "state").unwrap();
        file.write(b"new").unwrap();
        assert_eq!(read().as_deref(), Some(&b"new"[..]));
    }

    #[test]
    fn live_file_is_never_seen_in_part() {
        let place = place(2);
        let domain = Domain::join(&place.name, &place.folders[0], Role::Guest).unwrap();
        let mut file = LiveFile::new(&domain, "state").unwrap();
        file.write(&[0; 1000]).unwrap();
        std::thread::scope(|scope| {
            let writer = scope.spawn(|| {
                for round in 0..2000_u32 {
                    let content = vec![round as u8; 1 + (round as usize * 37) % 3000];
                    file.write(&content).unwrap();
                }
            });
            while !writer.is_finished() {
                // `None` after many replacements in a row is no error.
                if let Some(content) = LiveFile::read(&place.name, &place.folders, "state") {
                    assert!(!content.is_empty());
                    assert!(content.iter().all(|byte| *byte == content[0]));
                }
            }
        });
    }

    #[test]
    fn live_file_behind_a_link_or_too_large_is_ignored() {
        let place = place(3);
        let domain = Domain::join(&place.name, &place.folders[0], Role::Guest).unwrap();
        let mut file = LiveFile::new(&domain, "state").unwrap();
        file.write(b"content").unwrap();
        let link = domain.folder().join("link");
        std::os::unix::fs::symlink(domain.folder().join("state"), &link).unwrap();
        assert_eq!(read_live(&link), None);
        file.write(&vec![0; MAX_BYTES as usize + 1]).unwrap();
        assert_eq!(read_live(&domain.folder().join("state")), None);
    }
}
