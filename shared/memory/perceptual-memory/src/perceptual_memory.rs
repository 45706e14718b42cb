//! Perceptual memory: database, in-memory index, and two-phase mutations (stage, commit).

use std::collections::HashMap;
use std::sync::Arc;

use durable_leveldb::{Database, MutationId, Reader, StoreFolder};

use crate::archive::{ArchiveRecord, HistoryArchive, SegmentWriter};
use crate::decide::decide;
use crate::decision::{Decision, NewContent};
use crate::entry_applier::EntryApplier;
use crate::error::{Error, StorageError, StoreRefusal};
use crate::history::HistoryEntry;
use crate::label_status::DecisionStamp;
use crate::meta::{Meta, StoreId};
use crate::model::{Effect, MutationReceipt, RetentionLimits};
use crate::mutation::{Mutation, StoreChange};
use crate::record_batch::RecordBatch;
use crate::record_reader::{read_entries, read_entry};
use crate::size_record::SizeRecord;
use crate::store_index::StoreIndex;
use crate::watermark::Watermark;

/// Maximum number of track-ids in one lease.
pub const MAX_LEASE: u64 = 1 << 20;

/// Perceptual memory of one robot, open in one process.
///
/// After a [`StorageError::Io`] or [`StorageError::Damaged`] every call returns [`Error::Failed`]
/// until the store is dropped and opened again.
pub struct PerceptualMemory {
    pub(crate) engine: Database,
    pub(crate) index: StoreIndex,
    pub(crate) meta: Meta,
    pub(crate) limits: RetentionLimits,
    pub(crate) sizes: SizeRecord,
    /// Wall-clock time of the last mutation, for entries that the store writes itself.
    pub(crate) last_wall_ns: u64,
    pub(crate) archive: HistoryArchive,
    /// Archive segment that is being written.
    pub(crate) segment: Option<SegmentWriter>,
    /// Archive record with a segment that is complete, to be committed.
    pub(crate) completed_segment: Option<ArchiveRecord>,
    watermark: Watermark,
    staged: Staged,
    failure: Option<Arc<Error>>,
    /// Reason why the store can only be read, if that is so.
    pub(crate) read_only: Option<ReadOnly>,
    /// Locked folder; the last field, so that the database is closed before the lock is released.
    pub(crate) folder: StoreFolder,
}

/// Changes of the index that are not on disk yet.
#[derive(Default)]
struct Staged {
    writes: RecordBatch,
    /// Staged history entries by sequence number.
    entries: HashMap<u64, HistoryEntry>,
}

/// State of a store that can only be read.
pub(crate) struct ReadOnly {
    /// Error that keeps it from being written.
    pub(crate) reason: Arc<Error>,
    /// Sequence number of the last entry that was acknowledged: later ones may not be on disk.
    pub(crate) acknowledged: u64,
}

impl PerceptualMemory {
    pub(crate) fn new(
        (engine, archive): (Database, HistoryArchive),
        index: StoreIndex,
        meta: Meta,
        watermark: Watermark,
        folder: StoreFolder,
    ) -> Self {
        Self {
            engine,
            index,
            meta,
            limits: RetentionLimits::default(),
            sizes: SizeRecord::default(),
            last_wall_ns: 0,
            archive,
            segment: None,
            completed_segment: None,
            watermark,
            staged: Staged::default(),
            failure: None,
            read_only: None,
            folder,
        }
    }

    /// Id of this store; a rebuild changes it.
    pub fn store_id(&self) -> StoreId {
        self.meta.store_id()
    }

    /// Id of this memory, part of the provenance of its views on every robot; a rebuild keeps it.
    pub fn memory_id(&self) -> u128 {
        self.meta.memory_id()
    }

    /// Sets the retention limits, enforced from the next mutation on. The default is no limit.
    pub fn set_limits(&mut self, limits: RetentionLimits) {
        self.limits = limits;
    }

    /// Sequence number of the last history entry; zero for an empty history.
    pub fn sequence(&self) -> u64 {
        self.meta.sequence
    }

    /// Applies one mutation and returns when it is on disk.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] when nothing changed; otherwise the change may be on
    /// disk or not: open the store again and repeat it with the same id.
    pub fn apply(&mut self, mutation: &Mutation) -> Result<MutationReceipt, Error> {
        let answer = self.stage(mutation)?;
        self.commit()?;
        Ok(answer)
    }

    /// Leases `count` track-ids, starting at the returned one, that no other lease gives. The lease
    /// is on disk on return.
    ///
    /// # Errors
    ///
    /// As [`Self::apply`].
    pub fn lease_track_ids(&mut self, count: u64) -> Result<u64, Error> {
        let first = self.stage_lease(count)?;
        self.commit()?;
        Ok(first)
    }

    /// Flushes and closes the store.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`]; what was acknowledged is on disk all the same.
    pub fn close(self) -> Result<(), Error> {
        self.watermark
            .sync()
            .map_err(StorageError::io("syncing", "acknowledged"))?;
        Ok(self.engine.close()?)
    }

    /// Receipt of a mutation that was applied; `None` for an id that is not known.
    ///
    /// # Errors
    ///
    /// As [`Self::apply`].
    pub fn receipt(&mut self, id: MutationId) -> Result<Option<MutationReceipt>, Error> {
        self.usable()?;
        let recent = self.index.answered.get(&id).copied();
        let Some(sequence) = recent.or_else(|| self.archive.answered(id)) else {
            return Ok(None);
        };
        self.acknowledgeable(sequence)?;
        Ok(Some(self.entry(sequence)?.answer()))
    }

    /// Stages a mutation in the index; [`Self::commit`] makes it durable. Later staged mutations
    /// see it.
    pub(crate) fn stage(&mut self, mutation: &Mutation) -> Result<MutationReceipt, Error> {
        if let Some(answer) = self.receipt(mutation.id)? {
            return Ok(answer);
        }
        self.writable()?;
        mutation.check()?;
        let decision = match &mutation.change {
            StoreChange::Undo { sequence } => self.decide_undo(*sequence, mutation)?,
            StoreChange::Redo => self.decide_redo(mutation)?,
            change => decide(&self.index, &self.meta, change)?,
        };
        let id = Some(mutation.id);
        self.last_wall_ns = mutation.wall_ns;
        let author = (mutation.author.as_str(), mutation.requester.uid);
        Ok(self.stage_decision(id, author, mutation.wall_ns, decision))
    }

    /// Stages a decision as the next history entry, by an author and its user id.
    pub(crate) fn stage_decision(
        &mut self,
        mutation: Option<MutationId>,
        (author, uid): (&str, Option<u32>),
        wall_ns: u64,
        mut decision: Decision,
    ) -> MutationReceipt {
        self.date_documents(&mut decision.effects, author, wall_ns);
        self.meta.next_track_id = self.meta.next_track_id.max(decision.next_track_id);
        let entry = HistoryEntry {
            sequence: self.meta.sequence + 1,
            previous: self.meta.head,
            wall_ns,
            author: author.into(),
            uid,
            operation: decision.operation,
            mutation,
            effects: decision.effects,
            contradiction: decision.contradiction,
        };
        self.stage_entry(entry, &decision.contents)
    }

    /// Fixes the time stamps of document versions in the entry if the clock has stepped back. A
    /// purge may remove the earlier version from which the stamp would be derived.
    fn date_documents(&self, effects: &mut [Effect], author: &str, wall_ns: u64) {
        for effect in effects {
            let Effect::Document {
                document, decided, ..
            } = effect
            else {
                continue;
            };
            let last_ns = self.index.document_stamp_ns(document);
            if decided.is_none() && last_ns >= wall_ns {
                *decided = Some(DecisionStamp::after(last_ns, author.into(), wall_ns));
            }
        }
    }

    /// Stages a complete history entry.
    pub(crate) fn stage_entry(
        &mut self,
        entry: HistoryEntry,
        contents: &NewContent,
    ) -> MutationReceipt {
        let mut target = EntryApplier {
            index: &mut self.index,
            meta: &mut self.meta,
            writes: &mut self.staged.writes,
        };
        target.apply(&entry, contents);
        let answer = entry.answer();
        self.staged.entries.insert(entry.sequence, entry);
        answer
    }

    /// Replaces the metadata record of an empty store.
    pub(crate) fn begin_as(&mut self, meta: Meta) -> Result<(), Error> {
        self.meta = meta;
        self.staged.writes.touch();
        self.commit()
    }

    /// History entries by ascending sequence numbers, none of them lost: archived, in the database,
    /// or staged. Those that were dropped with the archive are left out.
    pub(crate) fn entries(&mut self, mut sequences: Vec<u64>) -> Result<Vec<HistoryEntry>, Error> {
        let archived = self.archive.record.sequence;
        let mut stored = sequences.split_off(sequences.partition_point(|s| *s <= archived));
        let is_stored = |sequence: &u64| !self.staged.entries.contains_key(sequence);
        let staged = stored.split_off(stored.partition_point(is_stored));
        let mut entries = Vec::new();
        for sequence in sequences {
            entries.extend(self.archive.entry(sequence)?);
        }
        entries.extend(self.read(|reader| read_entries(reader, &stored))?);
        let staged = staged.iter().map(|s| self.staged.entries[s].clone());
        entries.extend(staged);
        Ok(entries)
    }

    /// History entry by sequence number: staged, in the database, or archived.
    pub(crate) fn entry(&mut self, sequence: u64) -> Result<HistoryEntry, Error> {
        if let Some(entry) = self.staged.entries.get(&sequence) {
            return Ok(entry.clone());
        }
        let is_known = (1..=self.meta.sequence).contains(&sequence);
        if !is_known || self.index.is_lost(sequence) {
            return Err(StoreRefusal::UnknownEntry { sequence }.into());
        }
        if sequence > self.archive.record.sequence {
            return self.read(|reader| read_entry(reader, sequence));
        }
        let archived = self.archive.entry(sequence)?;
        archived.ok_or_else(|| StoreRefusal::UnknownEntry { sequence }.into())
    }

    /// Stages a lease; [`Self::commit`] makes it durable.
    pub(crate) fn stage_lease(&mut self, count: u64) -> Result<u64, Error> {
        self.usable()?;
        self.writable()?;
        let first = self.meta.next_track_id;
        if !(1..=MAX_LEASE).contains(&count) {
            return Err(StoreRefusal::LeaseSize {
                count,
                most: MAX_LEASE,
            }
            .into());
        }
        let end = first
            .checked_add(count)
            .ok_or(StoreRefusal::TrackIdsExhausted)?;
        self.meta.next_track_id = end;
        // The metadata record alone makes the lease.
        self.staged.writes.touch();
        Ok(first)
    }

    /// Commits all staged changes with one sync, then enforces the retention limits in a second
    /// commit.
    pub(crate) fn commit(&mut self) -> Result<(), Error> {
        self.commit_staged()?;
        if self.stage_limit_enforcement()? {
            self.commit_staged()?;
        }
        Ok(())
    }

    fn commit_staged(&mut self) -> Result<(), Error> {
        self.usable()?;
        let staged = std::mem::take(&mut self.staged);
        if staged.writes.is_empty() {
            return Ok(());
        }
        self.write(staged.writes)
    }

    /// Writes a batch with the metadata record, then the watermark.
    pub(crate) fn write(&mut self, batch: RecordBatch) -> Result<(), Error> {
        self.meta.records = self.index.records_digest();
        let written = batch.commit(&mut self.engine, &self.meta).and_then(|()| {
            let marked = self.watermark.write(&self.meta.mark());
            Ok(marked.map_err(StorageError::io("writing", "acknowledged"))?)
        });
        written.map_err(|error| self.fail(error))
    }

    /// Number of bytes staged for the next commit.
    pub(crate) fn n_staged_bytes(&self) -> usize {
        self.staged.writes.n_bytes()
    }

    /// Error of the write that made the store unusable.
    pub(crate) fn failure(&self) -> Option<&Error> {
        self.failure.as_deref()
    }

    pub(crate) fn usable(&self) -> Result<(), Error> {
        match &self.failure {
            Some(source) => Err(Error::Failed {
                source: Arc::clone(source),
            }),
            None => Ok(()),
        }
    }

    /// Records an error after which index and disk may differ.
    pub(crate) fn fail(&mut self, error: Error) -> Error {
        self.failure.get_or_insert_with(|| Arc::new(error.clone()));
        error
    }

    /// Runs a read; an error makes the store unusable until it is opened again.
    pub(crate) fn read<T>(
        &mut self,
        read: impl FnOnce(&Reader) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.usable()?;
        read(&self.engine.reader()).map_err(|error| self.fail(error))
    }
}

/// Stores that can only be read.
impl PerceptualMemory {
    /// `true` if the store can only be read.
    pub fn is_read_only(&self) -> bool {
        self.read_only.is_some()
    }

    /// Refuses to acknowledge an entry that may not be on disk: one that a failed write left in
    /// the log of a store that can only be read.
    pub(crate) fn acknowledgeable(&self, sequence: u64) -> Result<(), Error> {
        match &self.read_only {
            Some(read_only) if sequence > read_only.acknowledged => self.writable(),
            _ => Ok(()),
        }
    }

    /// Refuses changes of a store that can only be read.
    pub(crate) fn writable(&self) -> Result<(), Error> {
        match &self.read_only {
            Some(read_only) => Err(Error::ReadOnly {
                source: Arc::clone(&read_only.reason),
            }),
            None => Ok(()),
        }
    }
}
