//! Validation of a fakenect recording before playback.

use super::INDEX_NAME;
use super::error::Error;
use super::index::{FrameKind, IndexEntry, parse_index};
use file_access::{FileError, open_file, read_file};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Maximum size of an index, bytes; more than an hour of frames.
const MAX_INDEX_BYTES: u64 = 1 << 24;

/// Validated recording for the fakenect library.
#[derive(Debug, Clone)]
pub struct FakenectFolder {
    path: PathBuf,
    entries: Vec<IndexEntry>,
}

impl FakenectFolder {
    /// Opens and validates a recording: each listed file exists, is a regular file and has the
    /// header and size of its kind.
    ///
    /// *Complexity*: opens each listed file and reads a few bytes of it.
    ///
    /// # Errors
    /// When the index or a file is wrong or missing, or no depth is listed.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let mut index = Vec::new();
        read_file(&path.join(INDEX_NAME), MAX_INDEX_BYTES, &mut index)?;
        let entries = parse_index(&index)?;
        if !entries.iter().any(|entry| entry.kind == FrameKind::Depth) {
            return Err(Error::NoDepth);
        }
        for entry in &entries {
            check_frame(&path.join(&entry.file_name), entry.kind)?;
        }
        Ok(Self {
            path: path.to_owned(),
            entries,
        })
    }

    /// Folder of the recording, for the environment variable `FAKENECT_PATH`.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Frames in the order of their arrival.
    pub fn entries(&self) -> &[IndexEntry] {
        &self.entries
    }

    /// Playback time: sum of all pauses between frames.
    pub fn duration(&self) -> Duration {
        let pauses = self.entries.windows(2);
        pauses
            .map(|pair| pair[1].unix_time.saturating_sub(pair[0].unix_time))
            .sum()
    }
}

fn check_frame(path: &Path, kind: FrameKind) -> Result<(), Error> {
    let (file, found) = open_file(path)?;
    let header = kind.header();
    let needed = (header.len() + kind.n_bytes()) as u64;
    let mut start = Vec::with_capacity(header.len());
    file.take(header.len() as u64)
        .read_to_end(&mut start)
        .map_err(FileError::io(path, "read"))?;
    if start != header {
        let needed = std::str::from_utf8(header).unwrap_or_default().trim_end();
        return Err(Error::FrameHeader {
            path: path.to_owned(),
            needed,
        });
    }
    if found != needed {
        return Err(Error::FrameSize {
            path: path.to_owned(),
            found,
            needed,
        });
    }
    Ok(())
}
