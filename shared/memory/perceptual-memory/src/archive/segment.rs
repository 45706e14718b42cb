//! Archive segment: immutable file with a run of history entries.
//!
//! ```text
//! magic                 8 bytes
//! digest before         16 bytes: digest of the entry before the first
//! entries               the records as they were in the database, one after the other
//! index                 a record: where each entry ends, and who asked for it
//! length of the index   4 bytes
//! ```
//!
//! Each entry has a checksum, and names the digest of the entry before it. The digest of the last
//! one is in the index, and begins the next segment.

use std::fs::{self, File};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use durable_leveldb::record::unseal;
use serde::{Deserialize, Serialize};
use serde_bytes::ByteBuf;

use super::answered_mutations::AnsweredMutations;
use crate::digest::Digest;
use crate::error::Error;
use crate::history::HistoryEntry;

pub(super) const MAGIC: [u8; 8] = *b"TABHIST1";
/// Length of magic and digest before.
pub(super) const HEADER_BYTES: usize = 24;
/// Length of the length of the index.
const TRAILER_BYTES: usize = 4;

/// Index of a segment.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct SegmentIndex {
    pub(super) first: u64,
    /// Digest of the last entry.
    pub(super) head: Digest,
    /// Time of the last entry, nanoseconds since 1970, UTC.
    pub(super) last_wall_ns: u64,
    /// End of each entry in the file, little-endian `u64`; that of a lost entry is the end of the
    /// one before.
    pub(super) ends: ByteBuf,
    /// Idempotency keys of the entries, in order.
    pub(super) answered: AnsweredMutations,
}

/// Key of the index, for its checksum.
pub(super) fn index_key(first: u64) -> [u8; 9] {
    let mut key = [b'x'; 9];
    key[1..].copy_from_slice(&first.to_be_bytes());
    key
}

/// Segment opened for reading.
pub(crate) struct Segment {
    file: File,
    path: PathBuf,
    before: Digest,
    index: SegmentIndex,
}

impl Segment {
    /// Opens a segment and reads its index, but no entries.
    pub(super) fn open(path: &Path, first: u64, last: u64) -> Result<Self, Error> {
        read_index(path, first)
            .and_then(|(file, before, index)| {
                let segment = Self {
                    file,
                    path: path.to_owned(),
                    before,
                    index,
                };
                let is_whole = segment.index.first == first && segment.last() == last;
                is_whole
                    .then_some(segment)
                    .ok_or_else(|| invalid("its index is that of another segment"))
            })
            .map_err(|error| damaged(path, &error))
    }

    fn last(&self) -> u64 {
        self.index.first + (self.index.ends.len() / 8) as u64 - 1
    }

    /// Digest of the entry before the first.
    pub(crate) fn before(&self) -> Digest {
        self.before
    }

    /// Digest of the last entry.
    pub(super) fn head(&self) -> Digest {
        self.index.head
    }

    /// Time of the last entry, nanoseconds since 1970, UTC.
    pub(crate) fn last_wall_ns(&self) -> u64 {
        self.index.last_wall_ns
    }

    /// Idempotency keys of the entries.
    pub(super) fn into_answered(self) -> AnsweredMutations {
        self.index.answered
    }

    /// Reads an entry; `None` for a lost one.
    pub(crate) fn entry(&self, sequence: u64) -> Result<Option<HistoryEntry>, Error> {
        let Some((start, end)) = self.extent(sequence) else {
            return Ok(None);
        };
        let mut record = vec![0; (end - start) as usize];
        let read = self.file.read_exact_at(&mut record, start);
        let entry = read.and_then(|()| {
            let entry = HistoryEntry::unseal(sequence, &record);
            entry.map_err(|wrong| invalid(&format!("history entry {sequence}: {wrong}")))
        });
        match entry {
            Ok((entry, _)) => Ok(Some(entry)),
            Err(error) => Err(damaged(&self.path, &error)),
        }
    }

    /// Bytes of an entry in the file; `None` for a lost one.
    fn extent(&self, sequence: u64) -> Option<(u64, u64)> {
        let (ends, _) = self.index.ends.as_chunks::<8>();
        let at = sequence.checked_sub(self.index.first)? as usize;
        let end = u64::from_le_bytes(*ends.get(at)?);
        let before = at.checked_sub(1).and_then(|before| ends.get(before));
        let start = before.map_or(HEADER_BYTES as u64, |end| u64::from_le_bytes(*end));
        (start < end).then_some((start, end))
    }

    /// Visits all intact entries with their digests; returns the first fault and the sequence
    /// numbers of the damaged entries, if any.
    pub(super) fn visit(
        &self,
        mut visit: impl FnMut(HistoryEntry, Digest),
    ) -> Result<(), (Error, Vec<u64>)> {
        let all = || (self.index.first..=self.last()).collect();
        let bytes = fs::read(&self.path).map_err(|error| (damaged(&self.path, &error), all()))?;
        let mut fault = None;
        for sequence in self.index.first..=self.last() {
            let Some((start, end)) = self.extent(sequence) else {
                continue;
            };
            let record = bytes.get(start as usize..end as usize).unwrap_or_default();
            match HistoryEntry::unseal(sequence, record) {
                Ok((entry, digest)) => visit(entry, digest),
                Err(wrong) => {
                    let error = invalid(&format!("history entry {sequence}: {wrong}"));
                    let (_, lost) =
                        fault.get_or_insert_with(|| (damaged(&self.path, &error), Vec::new()));
                    lost.push(sequence);
                }
            }
        }
        fault.map_or(Ok(()), Err)
    }
}

/// Reads the two ends of a segment file.
fn read_index(path: &Path, first: u64) -> io::Result<(File, Digest, SegmentIndex)> {
    let file = File::open(path)?;
    let n_bytes = file.metadata()?.len();
    let mut header = [0; HEADER_BYTES];
    file.read_exact_at(&mut header, 0)?;
    let (magic, before) = header.split_at(MAGIC.len());
    if magic != MAGIC {
        return Err(invalid("it does not begin like a segment"));
    }
    let too_short = || invalid("it is too short");
    let index_end = n_bytes
        .checked_sub(TRAILER_BYTES as u64)
        .ok_or_else(too_short)?;
    let mut length = [0; TRAILER_BYTES];
    file.read_exact_at(&mut length, index_end)?;
    let n_index_bytes = u64::from(u32::from_le_bytes(length));
    let index_start = index_end.checked_sub(n_index_bytes).ok_or_else(too_short)?;
    let mut record = vec![0; n_index_bytes as usize];
    file.read_exact_at(&mut record, index_start)?;
    let index = unseal(&index_key(first), &record);
    let index = index.map_err(|wrong| invalid(&format!("its index: {wrong}")))?;
    let before = before.first_chunk().copied().unwrap_or_default();
    Ok((file, Digest(u128::from_be_bytes(before)), index))
}

fn invalid(wrong: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, wrong)
}

fn damaged(path: &Path, error: &io::Error) -> Error {
    Error::ArchiveDamaged {
        path: path.to_owned(),
        what: error.to_string(),
    }
}
