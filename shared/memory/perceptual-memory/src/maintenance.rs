//! Maintenance: stepwise compaction, and statistics of the store.

use std::fs;
use std::path::Path;

use crate::error::{Error, StorageError};
use crate::keys;
use crate::meta::{SCHEMA, StoreId};
use crate::perceptual_memory::PerceptualMemory;
use crate::purge;
use crate::record_batch::RecordBatch;

/// Tables of small records, compacted first.
const RECORD_TABLES: [u8; 6] = [
    keys::HISTORY,
    keys::ROW,
    keys::META,
    keys::DOCUMENT,
    keys::TOMBSTONE,
    keys::VIEW,
];
const CONTENT_TABLES: [u8; 2] = [keys::BLOB, keys::DESCRIPTOR];
/// Number of compaction steps per content table. Each step covers a part of the keys, so that a
/// store that is stopped does not compact for long.
const CONTENT_STEPS: usize = 64;
/// Estimated size of the records of a view besides its content, bytes.
const VIEW_RECORD_BYTES: u64 = 1000;
/// Estimated size of a history entry, bytes.
const ENTRY_BYTES: u64 = 300;

/// Statistics of the perceptual memory: sizes and counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stats {
    /// Id of the perceptual store.
    pub store_id: StoreId,
    /// Id of the perceptual memory.
    pub memory_id: u128,
    /// Schema version of the database.
    pub schema: u32,
    /// Sequence number of the last history entry.
    pub sequence: u64,
    /// Number of history entries lost with a damaged store.
    pub n_lost_entries: u64,
    /// Number of history entries in the archive.
    pub n_archived_entries: u64,
    /// Number of the oldest history entries that were dropped for the limit of the archive.
    pub n_dropped_entries: u64,
    /// Number of labelled views.
    pub n_named: u64,
    /// Number of unlabelled views.
    pub n_unnamed: u64,
    /// Number of forgotten views that are not purged yet.
    pub n_forgotten: u64,
    /// Number of categories.
    pub n_categories: u64,
    /// Number of documents.
    pub n_documents: u64,
    /// Number of tombstones of purged views.
    pub n_tombstones: u64,
    /// Total size of descriptors and point clouds, bytes, counted once per view.
    pub n_content_bytes: u64,
    /// Size of the database files, bytes.
    pub n_disk_bytes: u64,
    /// Size of the archived history, bytes.
    pub n_archive_bytes: u64,
    /// Size of damaged databases that were set aside, bytes.
    pub n_damaged_bytes: u64,
    /// Forecast of the size of database and archive in a year, bytes, from the growth of the last
    /// month; `None` on the first day.
    pub n_bytes_in_a_year: Option<u64>,
    /// First track-id that was never leased.
    pub next_track_id: u64,
}

impl PerceptualMemory {
    /// Number of steps of a full compaction; see [`Self::compact_step`].
    pub const N_COMPACT_STEPS: usize = Self::N_RECORD_STEPS + CONTENT_TABLES.len() * CONTENT_STEPS;

    /// Number of the first steps, which leave out descriptors, point clouds and document content.
    pub const N_RECORD_STEPS: usize = RECORD_TABLES.len();

    /// Starts the compaction of the tables of a part of the keys, which frees the space of deleted
    /// records. Reads and writes do not wait for it, and an incomplete one loses nothing.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`], [`StorageError::Io`] or [`Error::Failed`].
    pub fn compact_step(&mut self, step: usize) -> Result<(), Error> {
        self.usable()?;
        self.writable()?;
        let (from, to) = range_of(step);
        let compacted = self.engine.compact(&from, &to);
        compacted.map_err(|error| self.fail(error.into()))
    }

    /// `true` until the compaction that was started has ended.
    pub fn is_compacting(&self) -> bool {
        self.engine.is_compacting()
    }

    /// `true` if anything was forgotten or replaced before a time and is not purged yet.
    pub fn has_purgeable(&self, before_ns: u64) -> bool {
        !purge::decide(&self.index, before_ns).effects.is_empty()
    }

    /// `true` if a tombstone, or the note of a removed document, is older than a time.
    pub fn has_purgeable_tombstones(&self, before_ns: u64) -> bool {
        !purge::decide_tombstones(&self.index, before_ns)
            .effects
            .is_empty()
    }

    /// `true` if more than a third of the database files is content of deleted records, beyond some
    /// write buffers: compacting all of it pays.
    pub(crate) fn has_much_garbage(&self, write_buffer_bytes: u64) -> bool {
        let n_content: u64 = self.index.all().map(|(_, row)| row.n_bytes()).sum();
        let n_live = n_content
            + VIEW_RECORD_BYTES * self.index.n_all() as u64
            + ENTRY_BYTES * self.n_recent_entries();
        let n_disk = self.database_bytes().unwrap_or(0);
        n_disk > n_live + n_live / 2 + 4 * write_buffer_bytes
    }

    /// Size of the database files, bytes.
    pub(crate) fn database_bytes(&self) -> Result<u64, Error> {
        folder_bytes(&self.folder.database())
    }

    /// Records the size of the store if a day has passed since the last time.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`](crate::StorageError::Io) or [`Error::Failed`].
    pub fn record_size_when_due(&mut self, wall_ns: u64) -> Result<(), Error> {
        self.usable()?;
        self.writable()?;
        if !self.sizes.is_due(wall_ns) {
            return Ok(());
        }
        self.commit()?;
        let n_bytes = self.database_bytes()? + self.archive.record.n_bytes;
        self.sizes.add(wall_ns, n_bytes);
        let mut batch = RecordBatch::default();
        batch.put(&[keys::SIZES], &self.sizes);
        self.write(batch)
    }

    /// Statistics of the store at the time of the last mutation, or of the opening.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`] when the folder cannot be listed.
    pub fn stats(&self) -> Result<Stats, Error> {
        self.stats_at(self.last_wall_ns)
    }

    /// Statistics of the store at a time, nanoseconds since 1970, UTC.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`] when the folder cannot be listed.
    pub fn stats_at(&self, wall_ns: u64) -> Result<Stats, Error> {
        let index = &self.index;
        let archived = &self.archive.record;
        let n_disk_bytes = self.database_bytes()?;
        let n_bytes = n_disk_bytes + archived.n_bytes;
        let damaged = self.folder.damaged()?;
        let damaged = damaged.iter().map(|(_, path)| folder_bytes(path));
        Ok(Stats {
            store_id: self.store_id(),
            memory_id: self.memory_id(),
            schema: SCHEMA,
            sequence: self.sequence(),
            n_lost_entries: index.n_lost(),
            n_archived_entries: archived.sequence - archived.dropped,
            n_dropped_entries: archived.dropped,
            n_named: index.n_named() as u64,
            n_unnamed: index.n_unnamed() as u64,
            n_forgotten: index.n_forgotten() as u64,
            n_categories: index.n_categories() as u64,
            n_documents: index.documents().count() as u64,
            n_tombstones: index.n_tombstones() as u64,
            n_content_bytes: index.all().map(|(_, entry)| entry.n_bytes()).sum(),
            n_disk_bytes,
            n_archive_bytes: archived.n_bytes,
            n_damaged_bytes: damaged.sum::<Result<u64, Error>>()?,
            n_bytes_in_a_year: self.sizes.forecast(wall_ns, n_bytes),
            next_track_id: self.meta.next_track_id,
        })
    }
}

/// Total size of the files in a folder, bytes. A file that is removed meanwhile does not count.
fn folder_bytes(folder: &Path) -> Result<u64, Error> {
    let files = fs::read_dir(folder).map_err(StorageError::io("listing", folder))?;
    let sizes = files.flatten().filter_map(|file| file.metadata().ok());
    Ok(sizes.map(|size| size.len()).sum())
}

/// First and last key of a compaction step.
fn range_of(step: usize) -> (Vec<u8>, Vec<u8>) {
    const LAST: [u8; 4] = [0xff; 4];
    if let Some(&table) = RECORD_TABLES.get(step) {
        return (vec![table], [&[table][..], &LAST].concat());
    }
    let part = step - RECORD_TABLES.len();
    let table = CONTENT_TABLES[part / CONTENT_STEPS % CONTENT_TABLES.len()];
    let width = 256 / CONTENT_STEPS;
    let first = part % CONTENT_STEPS * width;
    let (first, last) = (first as u8, (first + width - 1) as u8);
    (vec![table, first], [&[table, last][..], &LAST].concat())
}
