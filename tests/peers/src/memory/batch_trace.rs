//! Writes down the batches that the store makes of its changes, so that another
//! LevelDB can write the same bytes.
//!
//! Each is read from the log just after it was written. Formats: LevelDB's
//! `doc/log_format.md`; `leveldb/trace.h` for the trace.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::ours;
use crate::plan::Plan;

const BLOCK_BYTES: usize = 32 * 1024;
const HEADER_BYTES: usize = 7;

/// Makes all steps of the plan on a store that is thrown away, in memory where
/// there is a folder for that, and writes their batches to `path`.
pub fn write(plan: &Plan, path: &Path) -> io::Result<()> {
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir())?;
    let mut trace = BufWriter::new(File::create(path)?);
    let mut memory = ours::open(folder.path());
    let mut log = LogTail::new(folder.path().join("database"));
    // What a new store begins with.
    log.next_batch()?;
    for step in 0..plan.n_steps() {
        ours::apply(&mut memory, plan, step);
        let batch = log.next_batch()?;
        trace.write_all(&(batch.len() as u32).to_le_bytes())?;
        trace.write_all(&batch)?;
    }
    trace.flush()
}

/// Follows the database from log to log.
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

    /// The one batch written since the last one.
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

    fn newest_log(&self) -> io::Result<PathBuf> {
        let mut newest = PathBuf::new();
        for entry in fs::read_dir(&self.database)? {
            let path = entry?.path();
            // Their numbers have leading zeros.
            if path.extension().is_some_and(|e| e == "log") && path > newest {
                newest = path;
            }
        }
        Ok(newest)
    }
}

/// The content of the fragments in a part of a log that begins at `offset`.
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
