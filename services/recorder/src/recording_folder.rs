//! Folder of the recordings: names, total size, free disk space.

use rustix::fs::{CWD, RenameFlags, renameat_with};
use rustix::io::Errno;
use service::Failure;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Ending of a closed recording.
const CLOSED: &str = ".mcap";
/// Ending of a recording that is being written, or was not closed.
const ACTIVE: &str = ".mcap.active";
/// Bytes of a megabyte.
pub(crate) const MEGABYTE: u64 = 1_000_000;

/// Folder with the recordings of one domain: `DOMAIN-SECONDS-NUMBER.mcap`, with the start of the
/// recording in seconds since 1970.
#[derive(Debug, Clone)]
pub(crate) struct RecordingFolder {
    folder: PathBuf,
    domain: String,
    start_s: u64,
}

impl RecordingFolder {
    /// Creates the folder if it is not there.
    ///
    /// # Errors
    /// When it cannot be created.
    pub(crate) fn create(folder: &Path, domain: &str, start_s: u64) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder).map_err(|error| {
            let sentence = format!(
                "could not create the folder {}: {error}; name another one with --out",
                folder.display()
            );
            Failure::general(sentence)
        })?;
        Ok(Self {
            folder: folder.to_owned(),
            domain: domain.to_owned(),
            start_s,
        })
    }

    /// Path of the folder.
    pub(crate) fn path(&self) -> &Path {
        &self.folder
    }

    /// Creates a file under the first free number behind the given one. Another recording that
    /// began in the same second may have any of them.
    ///
    /// # Errors
    /// When no file can be created in the folder.
    pub(crate) fn create_file(&self, number: u32) -> std::io::Result<NewFile> {
        let mut number = number;
        loop {
            number = number.checked_add(1).ok_or(ErrorKind::AlreadyExists)?;
            let path = self.active_path(number);
            match File::options().write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
                // Asked after the creation: the other recording may have closed its file since.
                Ok(_) if closed_path(&path).exists() => std::fs::remove_file(&path)?,
                Ok(file) => {
                    // Shows that the file is written. Where the file system has no locks, no
                    // recorder takes a file for one that was left.
                    drop(file.try_lock());
                    return Ok(NewFile { number, path, file });
                }
            }
        }
    }

    /// Path of a file that is being written, counted from 1.
    fn active_path(&self, number: u32) -> PathBuf {
        let Self {
            folder,
            domain,
            start_s,
        } = self;
        folder.join(format!("{domain}-{start_s}-{number:04}{ACTIVE}"))
    }

    /// Free space of the disk, megabytes; `None` when it is not known.
    pub(crate) fn free_mb(&self) -> Option<u64> {
        let disk = rustix::fs::statvfs(&self.folder).ok()?;
        Some(disk.f_bavail.saturating_mul(disk.f_frsize) / MEGABYTE)
    }

    /// Deletes the oldest recordings of the domain until all of them, with one that will be
    /// written, have at most `keep_mb`. Those of other runs go first: their names tell their age
    /// by a wall clock that may have been wrong.
    pub(crate) fn delete_oldest(&self, keep_mb: u64, next_bytes: u64) -> Deletion {
        let limit = keep_mb.saturating_mul(MEGABYTE);
        let mut recordings = self.recordings();
        recordings.sort();
        let sizes = recordings.iter().map(|recording| recording.bytes);
        let mut total = sizes.fold(next_bytes, u64::saturating_add);
        let mut n_files = 0;
        let mut refusal = None;
        for recording in recordings {
            if total <= limit {
                break;
            }
            match recording.delete() {
                Ok(()) => {
                    total = total.saturating_sub(recording.bytes);
                    n_files += 1;
                }
                Err(error) => refusal = Some((recording.path, error)),
            }
        }
        Deletion {
            n_files,
            refusal: refusal.filter(|_| total > limit),
        }
    }

    /// Recordings of this domain in the folder.
    fn recordings(&self) -> Vec<StoredRecording> {
        let entries = std::fs::read_dir(&self.folder)
            .into_iter()
            .flatten()
            .flatten();
        let recording = |entry: std::fs::DirEntry| {
            let name = entry.file_name().into_string().ok()?;
            let [start_s, number] = self.numbers(&name)?;
            Some(StoredRecording {
                is_own: start_s == self.start_s,
                start_s,
                number,
                path: entry.path(),
                bytes: entry.metadata().ok()?.len(),
            })
        };
        entries.filter_map(recording).collect()
    }

    /// Start and number in the name of a recording of this domain.
    fn numbers(&self, name: &str) -> Option<[u64; 2]> {
        let rest = name.strip_prefix(&self.domain)?.strip_prefix('-')?;
        let stem = rest.strip_suffix(ACTIVE).or(rest.strip_suffix(CLOSED));
        let (start_s, number) = stem?.split_once('-')?;
        Some([start_s.parse().ok()?, number.parse().ok()?])
    }
}

/// Recording in the folder, ordered by its age, those of other runs first.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct StoredRecording {
    is_own: bool,
    start_s: u64,
    number: u64,
    path: PathBuf,
    bytes: u64,
}

impl StoredRecording {
    /// Deletes the file, unless a recorder writes it.
    fn delete(&self) -> std::io::Result<()> {
        if self.path.to_string_lossy().ends_with(ACTIVE) {
            // A file that has just been created has neither a lock nor bytes.
            if self.bytes == 0 {
                return Err(ErrorKind::ResourceBusy.into());
            }
            File::open(&self.path)?.try_lock_shared()?;
        }
        std::fs::remove_file(&self.path)
    }
}

/// Result of deleting recordings.
#[derive(Debug)]
pub(crate) struct Deletion {
    pub(crate) n_files: u64,
    /// File that could not be deleted, and the reason, when the others were too few.
    pub(crate) refusal: Option<(PathBuf, std::io::Error)>,
}

/// New file of a recording.
#[derive(Debug)]
pub(crate) struct NewFile {
    pub(crate) number: u32,
    pub(crate) path: PathBuf,
    pub(crate) file: File,
}

/// Path of a recording when it is closed.
fn closed_path(active: &Path) -> PathBuf {
    active.with_extension("")
}

/// Gives a file that is closed its name, and returns it. A file that has the name stays.
///
/// # Errors
/// When a file has the name, or the file cannot be renamed.
pub(crate) fn give_name(active: &Path) -> std::io::Result<PathBuf> {
    let closed = closed_path(active);
    match renameat_with(CWD, active, CWD, &closed, RenameFlags::NOREPLACE) {
        // Some file systems, NFS among them, can do it only by a second link.
        Err(Errno::INVAL | Errno::NOSYS) => {
            std::fs::hard_link(active, &closed)?;
            std::fs::remove_file(active)?;
        }
        renamed => renamed?,
    }
    Ok(closed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn oldest_recordings_of_the_domain_are_deleted_and_those_of_this_run_last() {
        let folder = tempfile::tempdir().unwrap();
        let recordings = RecordingFolder::create(folder.path(), "left", 900).unwrap();
        let write = |name: &str, megabytes: usize| {
            let bytes = vec![0; megabytes * MEGABYTE as usize];
            std::fs::write(folder.path().join(name), bytes).unwrap();
        };
        for name in [
            "left-900-0001.mcap",
            "left-900-0002.mcap",
            "left-80-0007.mcap",
        ] {
            write(name, 2);
        }
        for name in [
            "left-901-0003.mcap.active",
            "right-1-0001.mcap",
            "left-x-1.mcap",
            "notes",
        ] {
            write(name, 1);
        }
        let deleted = |keep_mb| recordings.delete_oldest(keep_mb, MEGABYTE).n_files;
        assert_eq!([deleted(8), deleted(3)], [0, 3]);
        let mut left: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        left.sort();
        let expected = [
            "left-900-0002.mcap",
            "left-x-1.mcap",
            "notes",
            "right-1-0001.mcap",
        ];
        assert_eq!(left, expected);
    }

    #[test]
    fn recording_that_is_being_written_is_not_deleted() {
        let folder = tempfile::tempdir().unwrap();
        let [own, other] = [900, 700].map(|start_s| {
            let recordings = RecordingFolder::create(folder.path(), "left", start_s).unwrap();
            let mut new = recordings.create_file(0).unwrap();
            new.file.write_all(b"chunk").unwrap();
            (recordings, new)
        });
        let deletion = own.0.delete_oldest(0, 0);
        assert_eq!(deletion.n_files, 0);
        assert!(deletion.refusal.is_some());
        // As after a kill.
        drop(other.1.file);
        let deletion = own.0.delete_oldest(0, 0);
        assert_eq!(deletion.n_files, 1);
        assert_eq!(deletion.refusal.unwrap().0, own.1.path);
        assert!(!other.1.path.exists());
    }

    #[test]
    fn file_gets_its_name_when_it_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let recordings = RecordingFolder::create(folder.path(), "default", 7).unwrap();
        let new = recordings.create_file(1).unwrap();
        assert!(new.path.ends_with("default-7-0002.mcap.active"));
        let closed = give_name(&new.path).unwrap();
        assert!(closed.ends_with("default-7-0002.mcap") && closed.exists());
        assert!(!new.path.exists());
        assert!(recordings.free_mb().is_some());
    }

    #[test]
    fn files_of_recordings_of_the_same_second_all_stay() {
        let folder = tempfile::tempdir().unwrap();
        let recordings = || RecordingFolder::create(folder.path(), "default", 7).unwrap();
        let first = recordings().create_file(0).unwrap();
        let second = recordings().create_file(0).unwrap();
        let closed = give_name(&first.path).unwrap();
        let third = recordings().create_file(0).unwrap();
        assert_eq!([first.number, second.number, third.number], [1, 2, 3]);
        // As another recorder could have left it.
        std::fs::copy(&closed, closed_path(&second.path)).unwrap();
        let error = give_name(&second.path).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::AlreadyExists);
        assert!(second.path.exists());
    }
}
