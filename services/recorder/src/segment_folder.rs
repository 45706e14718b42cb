//! Folder of the recordings: names, total size, free disk space.

use service::Failure;
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
pub(crate) struct SegmentFolder {
    folder: PathBuf,
    domain: String,
    start_s: u64,
}

impl SegmentFolder {
    /// Creates the folder if it is not there.
    ///
    /// # Errors
    /// When it cannot be created.
    pub(crate) fn create(folder: &Path, domain: &str, start_s: u64) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder).map_err(|error| {
            let sentence = format!("could not create the folder {}: {error}", folder.display());
            Failure::general(sentence)
        })?;
        Ok(Self {
            folder: folder.to_owned(),
            domain: domain.to_owned(),
            start_s,
        })
    }

    /// Path of a file that is being written, counted from 1.
    pub(crate) fn active_path(&self, number: u32) -> PathBuf {
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

    /// Deletes the oldest closed recordings of the domain until all of them, with the one that is
    /// written, have at most `keep_mb`. Returns their number.
    pub(crate) fn delete_oldest(&self, keep_mb: u64, active_bytes: u64) -> u64 {
        let mut recordings = self.recordings();
        recordings.sort();
        let sizes = recordings.iter().map(|recording| recording.bytes);
        let mut total = active_bytes + sizes.sum::<u64>();
        let mut n_deleted = 0;
        for recording in recordings {
            if total <= keep_mb.saturating_mul(MEGABYTE) {
                break;
            }
            if std::fs::remove_file(&recording.path).is_ok() {
                total = total.saturating_sub(recording.bytes);
                n_deleted += 1;
            }
        }
        n_deleted
    }

    /// Closed recordings of this domain.
    fn recordings(&self) -> Vec<ClosedRecording> {
        let entries = std::fs::read_dir(&self.folder)
            .into_iter()
            .flatten()
            .flatten();
        let recording = |entry: std::fs::DirEntry| {
            let name = entry.file_name().into_string().ok()?;
            let [start_s, number] = self.numbers(&name)?;
            Some(ClosedRecording {
                start_s,
                number,
                path: entry.path(),
                bytes: entry.metadata().ok()?.len(),
            })
        };
        entries.filter_map(recording).collect()
    }

    /// Start and number in the name of a closed recording of this domain.
    fn numbers(&self, name: &str) -> Option<[u64; 2]> {
        let rest = name.strip_prefix(&self.domain)?.strip_prefix('-')?;
        let (start_s, number) = rest.strip_suffix(CLOSED)?.split_once('-')?;
        Some([start_s.parse().ok()?, number.parse().ok()?])
    }
}

/// Closed recording, ordered by its age.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ClosedRecording {
    start_s: u64,
    number: u64,
    path: PathBuf,
    bytes: u64,
}

/// Path of a recording when it is closed.
pub(crate) fn closed_path(active: &Path) -> PathBuf {
    active.with_extension("")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oldest_closed_recordings_of_the_domain_are_deleted() {
        let folder = tempfile::tempdir().unwrap();
        let segments = SegmentFolder::create(folder.path(), "left", 900).unwrap();
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
            "left-900-0003.mcap.active",
            "right-1-0001.mcap",
            "left-x-1.mcap",
            "notes",
        ] {
            write(name, 1);
        }
        assert_eq!(segments.delete_oldest(7, MEGABYTE), 0);
        assert_eq!(segments.delete_oldest(3, MEGABYTE), 2);
        let mut left: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        left.sort();
        let expected = [
            "left-900-0002.mcap",
            "left-900-0003.mcap.active",
            "left-x-1.mcap",
            "notes",
            "right-1-0001.mcap",
        ];
        assert_eq!(left, expected);
    }

    #[test]
    fn file_gets_its_name_when_it_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let segments = SegmentFolder::create(folder.path(), "default", 7).unwrap();
        let active = segments.active_path(2);
        assert!(active.ends_with("default-7-0002.mcap.active"));
        assert!(closed_path(&active).ends_with("default-7-0002.mcap"));
        assert!(segments.free_mb().is_some());
    }
}
