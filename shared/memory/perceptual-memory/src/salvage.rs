//! Rebuild of a damaged or older database from its intact records, with an account of the losses.
//!
//! Replay of the history: first the content that the archived entries imply is stored, then the
//! intact entries after them are applied in order. The effects of lost entries are inferred from
//! the other intact records. One final entry records the losses and the inferred effects.

use std::collections::{BTreeMap, BTreeSet};

use durable_leveldb::{Database, RawDatabase, StoreFolder, record::unseal};
use learning::ViewId;

use crate::archive::{self, HistoryArchive};
use crate::decision::NewContent;
use crate::document_key::DocumentKey;
use crate::entry_applier::EntryApplier;
use crate::error::Error;
use crate::history::HistoryEntry;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus};
use crate::meta::Meta;
use crate::model::{DataLoss, Effect, Operation};
use crate::record_batch::RecordBatch;
use crate::recovered_records::RecoveredRecords;
use crate::recovery;
use crate::store_index::StoreIndex;
use crate::view_record::ViewParts;
use crate::watermark::WatermarkRecord;

/// Batch size of writes to the copy, bytes.
const WRITE_BYTES: usize = 1 << 20;

/// Author of the final entry in the history.
const AUTHOR: &str = "the store itself";

/// Outcome of rebuilding a damaged or older store.
pub(crate) struct SalvageOutcome {
    pub(crate) loss: DataLoss,
    /// Older schema version, if the database was migrated.
    pub(crate) migrated_from: Option<u32>,
}

/// Copies everything intact from a database folder to the empty database `copy`; it is on disk on
/// return. `None` if nothing is intact.
///
/// # Errors
///
/// [`StorageError::NewerSchema`](crate::StorageError::NewerSchema);
/// [`StorageError::Io`](crate::StorageError::Io) when the folder cannot be read or the copy cannot
/// be written.
pub(crate) fn salvage(
    folder: &StoreFolder,
    copy: &mut Database,
    mark: Option<&WatermarkRecord>,
    wall_ns: u64,
) -> Result<Option<SalvageOutcome>, Error> {
    let raw = RawDatabase::read(&folder.database())?;
    let archive = open_archive(folder, &raw)?;
    let Some(recovered) = recovery::recover(&raw, &archive, mark)? else {
        return Ok(None);
    };
    let meta = Meta::new(Some(recovered.memory_id), recovered.next_track_id)?;
    let mut rebuild = Rebuilder {
        recovered: &recovered,
        raw: &raw,
        copy,
        index: StoreIndex::default(),
        meta,
        writes: RecordBatch::default(),
    };
    rebuild.restore_base()?;
    for entry in recovered.history.values() {
        rebuild.replay_entry(entry)?;
    }
    let loss = rebuild.end(wall_ns)?;
    Ok(Some(SalvageOutcome {
        loss,
        migrated_from: recovered.migrated_from,
    }))
}

/// Opens the archive up to the end that its record in the database states; if that is lost, all of
/// it counts.
fn open_archive(folder: &StoreFolder, raw: &RawDatabase) -> Result<HistoryArchive, Error> {
    let path = archive::path(folder);
    let key = [keys::ARCHIVE];
    match raw.get(&key).and_then(|record| unseal(&key, &record).ok()) {
        Some(record) => HistoryArchive::open(path, record),
        None => HistoryArchive::open_all(path),
    }
}

struct Rebuilder<'a> {
    recovered: &'a RecoveredRecords,
    raw: &'a RawDatabase,
    copy: &'a mut Database,
    index: StoreIndex,
    meta: Meta,
    writes: RecordBatch,
}

impl Rebuilder<'_> {
    /// Stores the content that the archived entries imply, as far as it is intact. The archive
    /// itself stays as it is.
    fn restore_base(&mut self) -> Result<(), Error> {
        let recovered = self.recovered;
        self.meta.sequence = recovered.archived.sequence;
        self.meta.head = recovered.archived.head;
        if recovered.archived.sequence > 0 {
            self.writes.put(&[keys::ARCHIVE], &recovered.archived);
        }
        for (view, projected) in &recovered.base.views {
            let parts = recovered.parts(self.raw, projected.identity);
            if let Some(parts) = parts.filter(ViewParts::are_complete) {
                self.applier()
                    .store(*view, &parts, projected.register.clone());
                self.flush_when_full()?;
            }
        }
        for ((document, sequence), version) in &recovered.base.versions {
            let content = version.content.as_ref();
            let content = content.and_then(|c| recovered.blob(self.raw, c.digest));
            self.applier()
                .put_version(document, *sequence, version.clone(), content.as_deref());
            self.flush_when_full()?;
        }
        for (identity, forgotten_ns) in &recovered.base.tombstones {
            self.applier().bury(*identity, Some(*forgotten_ns));
        }
        Ok(())
    }

    /// Replays an intact history entry. The hash chain of a history of schema 1, which had none, is
    /// computed.
    fn replay_entry(&mut self, entry: &HistoryEntry) -> Result<(), Error> {
        let mut entry = entry.clone();
        if self.recovered.migrated_from == Some(1) {
            entry.previous = self.meta.head;
        }
        let contents = self.contents_of(&entry.effects);
        self.apply(&entry, &contents)
    }

    fn apply(&mut self, entry: &HistoryEntry, contents: &NewContent) -> Result<(), Error> {
        self.applier().apply(entry, contents);
        self.flush_when_full()
    }

    fn applier(&mut self) -> EntryApplier<'_> {
        EntryApplier {
            index: &mut self.index,
            meta: &mut self.meta,
            writes: &mut self.writes,
        }
    }

    fn flush_when_full(&mut self) -> Result<(), Error> {
        if self.writes.n_bytes() < WRITE_BYTES {
            return Ok(());
        }
        std::mem::take(&mut self.writes).flush(self.copy)
    }

    /// Intact content that the given effects insert.
    fn contents_of(&self, effects: &[Effect]) -> NewContent {
        let mut contents = NewContent::default();
        for effect in effects {
            match effect {
                Effect::Stored { identity, .. } => {
                    let parts = self.recovered.parts(self.raw, *identity);
                    if let Some(parts) = parts.filter(ViewParts::are_complete) {
                        contents.views.insert(*identity, parts);
                    }
                }
                Effect::Document {
                    after: Some(content),
                    ..
                } => {
                    if let Some(bytes) = self.recovered.blob(self.raw, content.digest) {
                        contents.documents.insert(content.digest, bytes);
                    }
                }
                _ => {}
            }
        }
        contents
    }

    /// Writes the final entry and commits the copy.
    fn end(mut self, wall_ns: u64) -> Result<DataLoss, Error> {
        let lost = self.recovered.lost_entries(self.meta.sequence);
        let (effects, contents, mut loss) = self.effects_beyond_history();
        loss.n_history = lost.iter().map(|(first, last)| last - first + 1).sum();
        let last_sequence = lost.last().map_or(0, |(_, last)| *last);
        let is_whole = loss == DataLoss::default() && effects.is_empty();
        let operation = match self.recovered.migrated_from {
            Some(schema) if is_whole => Operation::Migrate { schema },
            _ => Operation::Rebuild { loss, lost },
        };
        let entry = HistoryEntry {
            sequence: self.meta.sequence.max(last_sequence) + 1,
            previous: self.meta.head,
            wall_ns,
            author: AUTHOR.into(),
            uid: None,
            operation,
            mutation: None,
            effects,
            contradiction: None,
        };
        self.apply(&entry, &contents)?;
        self.meta.records = self.index.records_digest();
        self.writes.commit(self.copy, &self.meta)?;
        Ok(loss)
    }

    /// Effects, content and losses by which the intact records differ from the replayed history.
    fn effects_beyond_history(&self) -> (Vec<Effect>, NewContent, DataLoss) {
        let mut last_entry = RebuildEntry::default();
        let made: BTreeSet<ViewId> = self.index.all().map(|(view, _)| view).collect();
        for (&view, identity) in &self.recovered.views {
            if self.index.get(view).is_none()
                && let Some(parts) = self.recovered.parts(self.raw, *identity)
            {
                self.recover_view(view, parts, &mut last_entry);
            }
        }
        for (&view, register) in &self.recovered.registers {
            let known = self.index.get(view).map(|entry| &entry.register);
            if let Some(known) = known
                && known.sequence < register.sequence
                && known.standing != register.standing
            {
                last_entry.effects.push(Effect::Changed {
                    view,
                    before: known.standing.clone(),
                    after: register.standing.clone(),
                    decided: Some(register.decided.clone()),
                });
            }
        }
        for (identity, forgotten_ns) in &self.recovered.tombstones {
            if self.index.tombstone(*identity).is_none() {
                last_entry.effects.push(Effect::Tombstone {
                    identity: *identity,
                    decided: Some(DecisionStamp {
                        author: AUTHOR.into(),
                        stamp_ns: *forgotten_ns,
                    }),
                });
            }
        }
        self.recover_documents(&mut last_entry);
        let kept = made.len() + last_entry.n_stored;
        last_entry.purge_missing(self.recovered.stored_by_history.difference(&made));
        last_entry.loss.n_views = self.recovered.n_views_expected.saturating_sub(kept as u64);
        (last_entry.effects, last_entry.contents, last_entry.loss)
    }

    /// Recovers a view whose history entry or point cloud is lost.
    fn recover_view(&self, view: ViewId, mut parts: ViewParts, last_entry: &mut RebuildEntry) {
        if self.recovered.stored_by_history.contains(&view) {
            // According to the history the view has a point cloud.
            last_entry.effects.push(Effect::Purged { view });
        }
        if parts.metadata.points.is_some() && parts.points.is_none() {
            parts.metadata.points = None;
            last_entry.loss.n_clouds += 1;
        }
        let identity = parts.metadata.identity();
        last_entry.effects.push(Effect::Stored { view, identity });
        last_entry.contents.views.insert(identity, parts);
        last_entry.stored.insert(view);
        last_entry.n_stored += 1;
        let standing = self.recovered.standing(view);
        if let Some((standing, decided)) = standing.filter(|(s, _)| *s != LabelStatus::Unnamed) {
            last_entry.effects.push(Effect::Changed {
                view,
                before: LabelStatus::Unnamed,
                after: standing,
                decided: Some(decided),
            });
        }
    }

    /// Recovers document versions that the replayed history lacks, and counts those without
    /// content.
    fn recover_documents(&self, last_entry: &mut RebuildEntry) {
        let mut present: BTreeMap<&DocumentKey, u64> = BTreeMap::new();
        for (key, sequence) in self.recovered.documents.keys() {
            present.insert(key, *sequence);
        }
        for (key, sequence) in present {
            let known = self.index.document(key);
            let Some(version) = self.recovered.documents.get(&(key.clone(), sequence)) else {
                continue;
            };
            if known.is_some_and(|(known, _)| known >= sequence) {
                continue;
            }
            if let Some(content) = &version.content {
                let Some(bytes) = self.recovered.blob(self.raw, content.digest) else {
                    let version = (key.clone(), sequence);
                    let is_counted = self.recovered.versions_by_history.contains(&version);
                    last_entry.loss.n_documents += u64::from(!is_counted);
                    continue;
                };
                last_entry.contents.documents.insert(content.digest, bytes);
            }
            last_entry.effects.push(Effect::Document {
                document: key.clone(),
                before: known.and_then(|(_, version)| version.content.clone()),
                after: version.content.clone(),
                decided: Some(version.decided.clone()),
            });
        }
        for (key, sequence) in &self.recovered.versions_by_history {
            if !self
                .index
                .versions()
                .any(|(k, s, ..)| (k, s) == (key, *sequence))
            {
                last_entry.loss.n_documents += 1;
                last_entry.effects.push(Effect::VersionPurged {
                    document: key.clone(),
                    sequence: *sequence,
                });
            }
        }
    }
}

/// Effects, content and losses of the final entry.
#[derive(Default)]
struct RebuildEntry {
    effects: Vec<Effect>,
    contents: NewContent,
    stored: BTreeSet<ViewId>,
    n_stored: usize,
    loss: DataLoss,
}

impl RebuildEntry {
    /// Marks views of the history that are lost as purged.
    fn purge_missing<'a>(&mut self, views: impl Iterator<Item = &'a ViewId>) {
        let gone = views.filter(|view| !self.stored.contains(view));
        let purged: Vec<Effect> = gone.map(|view| Effect::Purged { view: *view }).collect();
        self.effects.splice(0..0, purged);
    }
}
