//! Text files of WordNet: sorted lines in memory, and lines of a file by their offset.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;

use crate::error::Error;

/// Lines sorted by their first word, in the order of bytes, in memory.
#[derive(Debug)]
pub(super) struct SortedLines {
    bytes: Vec<u8>,
}

/// File of lines that are read by their offset.
#[derive(Debug)]
pub(super) struct LineFile {
    file: File,
}

/// Bytes that one read takes; most lines fit.
const BLOCK_BYTES: usize = 512;

/// Longest line that is read; the longest of WordNet 3.0 has 13 kB.
const LINE_BYTES_MAX: usize = 1 << 16;

impl SortedLines {
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(path).map_err(|source| unreadable(path, source))?;
        Ok(Self { bytes })
    }

    /// First line; empty if there is none.
    pub(super) fn first_line(&self) -> &[u8] {
        until(&self.bytes, b'\n')
    }

    /// Line whose first word is the key, by binary search. None if there is none.
    pub(super) fn find(&self, key: &str) -> Option<&str> {
        // The lines of the licence at the top have an empty first word.
        if key.is_empty() {
            return None;
        }
        let (mut from, mut to) = (0, self.bytes.len());
        while from < to {
            let middle = from + (to - from) / 2;
            let before = self.bytes[from..middle].iter().rposition(|b| *b == b'\n');
            let start = before.map_or(from, |newline| from + newline + 1);
            let line = until(&self.bytes[start..], b'\n');
            match until(line, b' ').cmp(key.as_bytes()) {
                std::cmp::Ordering::Equal => return std::str::from_utf8(line).ok(),
                std::cmp::Ordering::Less => from = start + line.len() + 1,
                std::cmp::Ordering::Greater => to = start,
            }
        }
        None
    }
}

impl LineFile {
    pub(super) fn open(path: &Path) -> Result<Self, Error> {
        let file = File::open(path).map_err(|source| unreadable(path, source))?;
        Ok(Self { file })
    }

    /// Line at an offset, at most 64 kB of it. None behind the end, or on an error.
    pub(super) fn line_at(&self, offset: u64) -> Option<String> {
        let mut line = Vec::new();
        let mut block = [0; BLOCK_BYTES];
        while line.len() < LINE_BYTES_MAX {
            let at = offset.checked_add(line.len() as u64)?;
            let n_read = self.file.read_at(&mut block, at).ok()?;
            let read = until(&block[..n_read], b'\n');
            line.extend_from_slice(read);
            if read.len() < BLOCK_BYTES {
                break;
            }
        }
        (!line.is_empty()).then(|| String::from_utf8(line).ok())?
    }
}

fn unreadable(path: &Path, source: std::io::Error) -> Error {
    Error::UnreadableFile {
        path: path.to_owned(),
        source,
    }
}

/// Bytes before the first occurrence of one, or all.
fn until(bytes: &[u8], end: u8) -> &[u8] {
    bytes.split(|byte| *byte == end).next().unwrap_or_default()
}
