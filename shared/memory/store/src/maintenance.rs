//! What keeps a store small and tells how it is.

use std::fs;

use crate::error::Error;
use crate::keys;
use crate::meta::{SCHEMA, StoreId};
use crate::perceptual_memory::PerceptualMemory;
use crate::purge;

/// Steps in which the tables of content are compacted: each is a part of the keys,
/// so that nobody waits long.
const CONTENT_STEPS: usize = 64;
const CONTENT_TABLES: [u8; 2] = [keys::BLOB, keys::DESCRIPTOR];
const OTHER_TABLES: [u8; 6] = [
    keys::HISTORY,
    keys::REGISTER,
    keys::META,
    keys::DOCUMENT,
    keys::TOMBSTONE,
    keys::VIEW,
];

/// How much there is, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stats {
    /// Which store it is.
    pub store_id: StoreId,
    /// Whose memory it is.
    pub memory_id: u128,
    /// The form in which it is stored.
    pub schema: u32,
    /// Sequence of the last history entry.
    pub sequence: u64,
    /// History entries that a damaged store has lost.
    pub n_lost_entries: u64,
    /// Views with a name.
    pub n_named: u64,
    /// Views without one.
    pub n_unnamed: u64,
    /// Views that were forgotten and not yet removed.
    pub n_forgotten: u64,
    /// Categories.
    pub n_categories: u64,
    /// Documents.
    pub n_documents: u64,
    /// Forgotten views of which the content is gone.
    pub n_tombstones: u64,
    /// Bytes of descriptors and clouds, each view's counted.
    pub n_content_bytes: u64,
    /// Bytes of the database's files.
    pub n_disk_bytes: u64,
    /// The first track-id that was never leased.
    pub next_track_id: u64,
}

impl PerceptualMemory {
    /// Number of steps of [`Self::compact_step`].
    pub const N_COMPACT_STEPS: usize = CONTENT_TABLES.len() * CONTENT_STEPS + OTHER_TABLES.len();

    /// Merges the tables of a part of the keys, so that what was removed leaves the
    /// disk. Nothing is lost when not all steps are made.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`], [`Error::Io`] or [`Error::Failed`].
    pub fn compact_step(&mut self, step: usize) -> Result<(), Error> {
        self.usable()?;
        let (from, to) = range_of(step);
        let compacted = self.engine.compact(&from, &to);
        compacted.map_err(|error| self.fail(error))
    }

    /// Whether anything was forgotten or replaced before that time and not yet removed.
    pub fn has_purgeable(&self, before_ns: u64) -> bool {
        !purge::decide(&self.catalogue, before_ns).effects.is_empty()
    }

    /// How much there is.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the folder cannot be listed.
    pub fn stats(&self) -> Result<Stats, Error> {
        let catalogue = &self.catalogue;
        let database = self.folder.database();
        let files = fs::read_dir(&database).map_err(Error::io("listing", &database))?;
        let sizes = files.flatten().filter_map(|file| file.metadata().ok());
        Ok(Stats {
            store_id: self.store_id(),
            memory_id: self.memory_id(),
            schema: SCHEMA,
            sequence: self.sequence(),
            n_lost_entries: catalogue.n_lost(),
            n_named: catalogue.n_named() as u64,
            n_unnamed: catalogue.n_unnamed() as u64,
            n_forgotten: catalogue.n_forgotten() as u64,
            n_categories: catalogue.n_categories() as u64,
            n_documents: catalogue.documents().count() as u64,
            n_tombstones: catalogue.tombstones.len() as u64,
            n_content_bytes: catalogue.all().map(|(_, entry)| entry.n_bytes()).sum(),
            n_disk_bytes: sizes.map(|size| size.len()).sum(),
            next_track_id: self.meta.next_track_id,
        })
    }
}

/// First and last key of a step.
fn range_of(step: usize) -> (Vec<u8>, Vec<u8>) {
    let n_content = CONTENT_TABLES.len() * CONTENT_STEPS;
    if step < n_content {
        let table = CONTENT_TABLES[step / CONTENT_STEPS];
        let width = 256 / CONTENT_STEPS;
        let first = step % CONTENT_STEPS * width;
        let (first, last) = (first as u8, (first + width - 1) as u8);
        return (
            vec![table, first],
            vec![table, last, 0xff, 0xff, 0xff, 0xff],
        );
    }
    let table = OTHER_TABLES[(step - n_content) % OTHER_TABLES.len()];
    (vec![table], vec![table, 0xff, 0xff, 0xff, 0xff])
}
