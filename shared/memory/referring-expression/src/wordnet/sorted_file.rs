//! Text file of sorted lines, with binary search by the first word of a line.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;

use crate::error::Error;

/// File of lines sorted by their first word, in the order of bytes.
#[derive(Debug)]
pub(super) struct SortedFile {
    file: File,
    n_bytes: u64,
}

/// Bytes that one read takes; most lines fit.
const BLOCK_BYTES: usize = 512;

/// Longest line that is read; the longest of WordNet 3.0 has 13 kB.
const LINE_BYTES_MAX: usize = 1 << 16;

impl SortedFile {
    pub(super) fn open(path: &Path) -> Result<Self, Error> {
        let unreadable = |source| Error::UnreadableFile {
            path: path.to_owned(),
            source,
        };
        let file = File::open(path).map_err(unreadable)?;
        let n_bytes = file.metadata().map_err(unreadable)?.len();
        Ok(Self { file, n_bytes })
    }

    /// Line whose first word is the key. None if there is none, or on an error.
    pub(super) fn find(&self, key: &str) -> Option<String> {
        if key.is_empty() || key.contains(' ') {
            return None;
        }
        let (mut from, mut to) = (0, self.n_bytes);
        while from < to {
            let middle = from + (to - from) / 2;
            let start = self.line_start(middle)?;
            if start >= to {
                to = middle;
                continue;
            }
            let line = self.bytes_at(start)?;
            let word = line.split(|byte| *byte == b' ').next().unwrap_or_default();
            match word.cmp(key.as_bytes()) {
                std::cmp::Ordering::Equal => return String::from_utf8(line).ok(),
                std::cmp::Ordering::Less => from = start + line.len() as u64 + 1,
                std::cmp::Ordering::Greater => to = middle,
            }
        }
        None
    }

    /// Line at an offset. None behind the end, or on an error.
    pub(super) fn line_at(&self, offset: u64) -> Option<String> {
        String::from_utf8(self.bytes_at(offset)?).ok()
    }

    /// First start of a line at or after an offset; the length of the file if there is none.
    fn line_start(&self, offset: u64) -> Option<u64> {
        match offset.checked_sub(1) {
            None => Some(0),
            Some(before) => {
                let rest = self.bytes_at(before)?;
                Some((before + rest.len() as u64 + 1).min(self.n_bytes))
            }
        }
    }

    /// Bytes from an offset up to the end of the line.
    fn bytes_at(&self, offset: u64) -> Option<Vec<u8>> {
        if offset >= self.n_bytes {
            return None;
        }
        let mut line = Vec::new();
        let mut block = [0; BLOCK_BYTES];
        while line.len() < LINE_BYTES_MAX {
            let n_read = self
                .file
                .read_at(&mut block, offset + line.len() as u64)
                .ok()?;
            let read = &block[..n_read];
            if let Some(end) = read.iter().position(|byte| *byte == b'\n') {
                line.extend_from_slice(&read[..end]);
                return Some(line);
            }
            if n_read == 0 {
                return Some(line);
            }
            line.extend_from_slice(read);
        }
        None
    }
}
