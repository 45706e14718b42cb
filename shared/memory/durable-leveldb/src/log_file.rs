//! Log file: the batches that are not in a table yet, in LevelDB's log format.
//!
//! Format: LevelDB's `doc/log_format.md`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::crc32c::{crc32c, mask};
use crate::env_health::EnvHealth;
use crate::synced_file::SyncedFile;
use crate::verified_files::{
    LOG_BLOCK_BYTES, LOG_FIRST, LOG_FULL, LOG_HEADER_BYTES, LOG_LAST, LOG_MIDDLE,
};

/// Extension of the log files.
pub(crate) const LOG: &str = "wal";

/// Log file that is being written. Dropping it syncs it.
pub(crate) struct LogFile {
    file: SyncedFile,
    n_bytes: usize,
}

impl LogFile {
    /// Creates the log, and makes its name durable.
    pub(crate) fn create(path: &Path, health: &Arc<EnvHealth>) -> io::Result<Self> {
        Ok(Self {
            file: SyncedFile::create_new(path, health)?,
            n_bytes: 0,
        })
    }

    /// Appends a record.
    pub(crate) fn append(&mut self, record: &[u8]) -> io::Result<()> {
        let bytes = framed(record, self.n_bytes);
        self.file.write_all(&bytes)?;
        self.n_bytes += bytes.len();
        Ok(())
    }

    /// Makes all appended records durable.
    pub(crate) fn sync(&mut self) -> io::Result<()> {
        self.file.flush()
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.file.path().to_owned()
    }
}

/// Fragments of a record, with their headers, for a log of `n_before` bytes.
fn framed(record: &[u8], n_before: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(record.len() + LOG_HEADER_BYTES);
    let mut rest = record;
    let mut is_first = true;
    loop {
        let mut room = LOG_BLOCK_BYTES - (n_before + bytes.len()) % LOG_BLOCK_BYTES;
        if room < LOG_HEADER_BYTES {
            // No header crosses the end of a block.
            bytes.resize(bytes.len() + room, 0);
            room = LOG_BLOCK_BYTES;
        }
        let (part, later) = rest.split_at(rest.len().min(room - LOG_HEADER_BYTES));
        let kind = match (is_first, later.is_empty()) {
            (true, true) => LOG_FULL,
            (true, false) => LOG_FIRST,
            (false, false) => LOG_MIDDLE,
            (false, true) => LOG_LAST,
        };
        bytes.extend(mask(crc32c(&[&[kind], part])).to_le_bytes());
        bytes.extend((part.len() as u16).to_le_bytes());
        bytes.push(kind);
        bytes.extend(part);
        (rest, is_first) = (later, false);
        if rest.is_empty() {
            return bytes;
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Log with these records, and the offset of each.
    pub(crate) fn log_of<'a>(records: impl IntoIterator<Item = &'a [u8]>) -> (Vec<usize>, Vec<u8>) {
        let (mut starts, mut log) = (Vec::new(), Vec::new());
        for record in records {
            let room = LOG_BLOCK_BYTES - log.len() % LOG_BLOCK_BYTES;
            let padding = if room < LOG_HEADER_BYTES { room } else { 0 };
            starts.push(log.len() + padding);
            log.extend(framed(record, log.len()));
        }
        (starts, log)
    }
}
