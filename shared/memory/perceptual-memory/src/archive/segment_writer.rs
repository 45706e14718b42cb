//! Writer of an archive segment: takes consecutive history entries and checks their chain.

use std::path::Path;

use durable_leveldb::record::seal;
use durable_leveldb::{Database, DurableFile, MutationId};
use serde_bytes::ByteBuf;

use super::answered_mutations::AnsweredMutations;
use super::archive_record::ArchiveRecord;
use super::segment::{HEADER_BYTES, MAGIC, SegmentIndex, index_key};
use crate::digest::Digest;
use crate::error::Error;
use crate::history::HistoryEntry;
use crate::keys;

/// Segment that is being written; dropping it leaves nothing behind.
pub(crate) struct SegmentWriter {
    file: DurableFile,
    n_bytes: u64,
    index: SegmentIndex,
    /// Idempotency keys of the entries, with their offsets from the first.
    mutations: Vec<(MutationId, u32)>,
    /// Sequence number of the next entry.
    next: u64,
}

impl SegmentWriter {
    /// Begins the segment that follows the archived entries.
    pub(super) fn begin(
        engine: &Database,
        path: &Path,
        archived: &ArchiveRecord,
    ) -> Result<Self, Error> {
        let first = archived.sequence + 1;
        let mut writer = Self {
            file: engine.create_file(path)?,
            n_bytes: 0,
            index: SegmentIndex {
                first,
                head: archived.head,
                last_wall_ns: 0,
                ends: ByteBuf::new(),
                answered: AnsweredMutations::default(),
            },
            mutations: Vec::new(),
            next: first,
        };
        let mut header = [0; HEADER_BYTES];
        header[..MAGIC.len()].copy_from_slice(&MAGIC);
        header[MAGIC.len()..].copy_from_slice(&archived.head.0.to_be_bytes());
        writer.write(&header)?;
        Ok(writer)
    }

    /// Sequence number of the next entry.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// Number of entries so far.
    pub(crate) fn len(&self) -> u64 {
        self.next - self.index.first
    }

    /// Appends the entries before `next`, with a gap for each lost one, and syncs them.
    pub(crate) fn append(&mut self, entries: &[(u64, Vec<u8>)], next: u64) -> Result<(), Error> {
        let mut bytes = Vec::new();
        for (sequence, record) in entries {
            let damaged = |wrong| keys::record_error(&keys::history_key(*sequence), wrong);
            let (entry, digest) = HistoryEntry::unseal(*sequence, record).map_err(damaged)?;
            self.skip_to(*sequence, bytes.len());
            bytes.extend_from_slice(record);
            self.note(&entry, digest, bytes.len());
        }
        self.skip_to(next, bytes.len());
        self.write(&bytes)?;
        Ok(self.file.sync()?)
    }

    /// Notes the entries before `sequence` as lost.
    fn skip_to(&mut self, sequence: u64, n_pending_bytes: usize) {
        while self.next < sequence {
            self.end_entry(n_pending_bytes);
        }
    }

    fn note(&mut self, entry: &HistoryEntry, digest: Digest, n_pending_bytes: usize) {
        if let Some(id) = entry.mutation {
            let offset = (entry.sequence - self.index.first) as u32;
            self.mutations.push((id, offset));
        }
        self.index.head = digest;
        self.index.last_wall_ns = entry.wall_ns;
        self.end_entry(n_pending_bytes);
    }

    fn end_entry(&mut self, n_pending_bytes: usize) {
        let end = self.n_bytes + n_pending_bytes as u64;
        self.index.ends.extend(end.to_le_bytes());
        self.next += 1;
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.file.write(bytes)?;
        self.n_bytes += bytes.len() as u64;
        Ok(())
    }

    /// Completes the file; it is durable on return. Returns its index, and its size,
    /// bytes.
    pub(super) fn finish(mut self) -> Result<(SegmentIndex, u64), Error> {
        self.index.answered = AnsweredMutations::new(std::mem::take(&mut self.mutations));
        let index = seal(&index_key(self.index.first), &self.index);
        self.write(&index)?;
        self.write(&(index.len() as u32).to_le_bytes())?;
        self.file.commit()?;
        Ok((self.index, self.n_bytes))
    }
}
