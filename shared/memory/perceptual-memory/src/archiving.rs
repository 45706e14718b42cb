//! Archiving: moves the oldest history entries from the database to the archive, in steps that are
//! short enough for a waiting request.
//!
//! The segment is on disk, with its name, before the batch that advances the archive record and
//! removes its entries from the database. A crash between the two leaves the entries twice, and the
//! segment is written again.

use std::ops::ControlFlow;

use crate::archive::{ArchiveRecord, SegmentWriter};
use crate::error::Error;
use crate::keys;
use crate::perceptual_memory::PerceptualMemory;
use crate::record_batch::RecordBatch;

/// Number of entries that one step copies. Chosen: reading and syncing them takes some
/// milliseconds.
const STEP_ENTRIES: u64 = 512;

/// Result of an archiving step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ArchivingStep {
    /// Nothing was due.
    Idle,
    /// A part of the work was done; call again.
    Done,
    /// The oldest archived entries were dropped for the limit of the archive.
    Dropped {
        /// First dropped entry.
        first: u64,
        /// Last dropped entry.
        last: u64,
    },
}

impl PerceptualMemory {
    /// Does one bounded step of archiving: copies some entries, completes a segment, removes its
    /// entries from the database, or drops the oldest segment.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`](crate::StorageError::Io) when the segment cannot be written,
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`]. The entries
    /// are in the database until they are in the archive.
    pub fn archive_step(&mut self) -> Result<ArchivingStep, Error> {
        self.writable()?;
        // The archive record must not be written with staged changes.
        self.commit()?;
        if let Some(record) = self.completed_segment.take() {
            self.commit_segment(record)?;
            return Ok(ArchivingStep::Done);
        }
        match self.segment.take() {
            Some(writer) if writer.len() == self.limits.history.segment_entries => {
                let record = self.archive.finish_segment(writer, self.index.lost())?;
                self.completed_segment = Some(record);
                Ok(ArchivingStep::Done)
            }
            Some(mut writer) => {
                self.copy_entries(&mut writer)?;
                self.segment = Some(writer);
                Ok(ArchivingStep::Done)
            }
            None if self.is_archiving_due() => {
                let n_entries = self.limits.history.segment_entries;
                self.segment = Some(self.archive.begin_segment(&self.engine, n_entries)?);
                Ok(ArchivingStep::Done)
            }
            None => self.drop_oldest_segment(),
        }
    }

    /// `true` if more entries are in the database than are kept there.
    pub fn is_archiving_due(&self) -> bool {
        let limits = &self.limits.history;
        let n_archivable = limits.kept_entries.saturating_add(limits.segment_entries);
        self.n_recent_entries() >= n_archivable
    }

    /// Number of the newest history entries that are in the database.
    pub fn n_recent_entries(&self) -> u64 {
        self.meta.sequence - self.archive.record.sequence
    }

    fn copy_entries(&mut self, writer: &mut SegmentWriter) -> Result<(), Error> {
        let n_left = self.limits.history.segment_entries - writer.len();
        let first = writer.next();
        let last = first + n_left.min(STEP_ENTRIES) - 1;
        let mut entries = Vec::new();
        self.read(|reader| {
            reader.scan(
                &keys::history_key(first),
                |key, record| match keys::sequence_of(key) {
                    Some(sequence) if sequence <= last => {
                        entries.push((sequence, record.to_vec()));
                        ControlFlow::Continue(())
                    }
                    _ => ControlFlow::Break(()),
                },
            )?;
            Ok(())
        })?;
        let mut found = entries.iter().map(|(sequence, _)| *sequence).peekable();
        for sequence in first..=last {
            if found.next_if_eq(&sequence).is_none() && !self.index.is_lost(sequence) {
                let key = keys::history_key(sequence);
                return Err(self.fail(keys::record_error(&key, "it is missing")));
            }
        }
        writer.append(&entries, last + 1)
    }

    /// Advances the archive record and removes the archived entries from the database.
    fn commit_segment(&mut self, record: ArchiveRecord) -> Result<(), Error> {
        let mut batch = RecordBatch::default();
        batch.put(&[keys::ARCHIVE], &record);
        for sequence in self.archive.record.sequence + 1..=record.sequence {
            batch.delete(&keys::history_key(sequence));
        }
        self.write(batch)?;
        let last = record.sequence;
        self.archive.record = record;
        // From now on the archive has their idempotency keys.
        self.index.answered.retain(|_, sequence| *sequence > last);
        let kept_ns = self.limits.history.answered_kept_ns;
        let before_ns = self.last_wall_ns.saturating_sub(kept_ns);
        self.archive.expire_answered(before_ns);
        Ok(())
    }

    /// Drops the oldest segment when the archive is above its limit. The archive record comes
    /// first: a file that it gives as dropped is removed at the next opening at the latest.
    fn drop_oldest_segment(&mut self) -> Result<ArchivingStep, Error> {
        if self.archive.record.n_bytes <= self.limits.history.archive_max_bytes {
            return Ok(ArchivingStep::Idle);
        }
        let Some(((first, last), record)) = self.archive.oldest() else {
            return Ok(ArchivingStep::Idle);
        };
        let mut batch = RecordBatch::default();
        batch.put(&[keys::ARCHIVE], &record);
        self.write(batch)?;
        self.archive.record = record;
        self.archive.remove_segment((first, last))?;
        Ok(ArchivingStep::Dropped { first, last })
    }
}
