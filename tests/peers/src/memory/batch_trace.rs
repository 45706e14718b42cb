//! Recording of the store's write batches, so that another LevelDB can replay the same bytes.
//!
//! Each batch is read from the write-ahead log just after it was written. Formats: LevelDB's
//! `doc/log_format.md`; `leveldb/trace.h` for the trace.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::tabula_store;
use crate::workload::Workload;

/// Block size of the log, bytes.
const BLOCK_BYTES: usize = 32 * 1024;
/// Size of a fragment header, bytes: checksum (4), length (2), kind (1).
const HEADER_BYTES: usize = 7;

/// Applies the workload to a temporary store, in memory where `/dev/shm` exists, and writes its
/// batches to `path`.
///
/// # Errors
/// If a file cannot be read or written.
pub fn write(workload: &Workload, path: &Path) -> io::Result<()> {
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir())?;
    let mut trace = BufWriter::new(File::create(path)?);
    let mut memory = tabula_store::open_new(folder.path());
    let mut log = LogTail::new(folder.path().join("database"));
    // The first records of a new store and its lease of track-ids are not part of the trace.
    log.next_batch()?;
    for step in 0..workload.n_steps() {
        tabula_store::apply(&mut memory, workload, step);
        let batch = log.next_batch()?;
        trace.write_all(&(batch.len() as u32).to_le_bytes())?;
        trace.write_all(&batch)?;
    }
    trace.flush()
}

/// Tail of the write-ahead log, across log files.
struct LogTail {
    database: PathBuf,
    log: PathBuf,
    offset: usize,
}

impl LogTail {
    fn new(database: PathBuf) -> Self {
        Self {
            database,
            log: PathBuf::new(),
            offset: 0,
        }
    }

    /// The batch written since the last call.
    fn next_batch(&mut self) -> io::Result<Vec<u8>> {
        let newest = self.newest_log()?;
        if newest != self.log {
            self.log = newest;
            self.offset = 0;
        }
        let mut file = File::open(&self.log)?;
        file.seek(SeekFrom::Start(self.offset as u64))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let batch = join_fragments(self.offset, &bytes);
        self.offset += bytes.len();
        Ok(batch)
    }

    /// Path of the newest log file.
    fn newest_log(&self) -> io::Result<PathBuf> {
        let mut newest = PathBuf::new();
        for entry in fs::read_dir(&self.database)? {
            let path = entry?.path();
            // The file names are numbers with leading zeros, so they sort as text.
            if path.extension().is_some_and(|e| e == "log") && path > newest {
                newest = path;
            }
        }
        Ok(newest)
    }
}

/// Joins the fragments of a part of a log that begins at `offset`.
fn join_fragments(offset: usize, mut bytes: &[u8]) -> Vec<u8> {
    let n_bytes = bytes.len();
    let mut joined = Vec::with_capacity(n_bytes);
    while !bytes.is_empty() {
        let at = offset + n_bytes - bytes.len();
        let room = BLOCK_BYTES - at % BLOCK_BYTES;
        if room < HEADER_BYTES {
            bytes = &bytes[room..];
            continue;
        }
        let n_content = u16::from_le_bytes([bytes[4], bytes[5]]) as usize;
        let (fragment, rest) = bytes.split_at(HEADER_BYTES + n_content);
        joined.extend_from_slice(&fragment[HEADER_BYTES..]);
        bytes = rest;
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trace_has_one_batch_per_step() {
        let workload = Workload::new(0.01);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trace");
        write(&workload, &path).unwrap();
        let trace = fs::read(path).unwrap();
        let (mut rest, mut n_batches) = (&trace[..], 0);
        while let Some((length, after)) = rest.split_first_chunk() {
            let (batch, after) = after.split_at(u32::from_le_bytes(*length) as usize);
            // Sequence (8 bytes), number of operations (4 bytes), operations.
            let n_operations = u32::from_le_bytes(batch[8..12].try_into().unwrap());
            assert!(n_operations > 0);
            (rest, n_batches) = (after, n_batches + 1);
        }
        assert_eq!(n_batches, workload.n_steps());
    }
}
