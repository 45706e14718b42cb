//! Intact records recovered from the files of a damaged database, and the totals they imply.

use std::collections::{BTreeMap, BTreeSet};

use durable_leveldb::{RawDatabase, record::unseal};
use learning::ViewId;
use serde_bytes::ByteBuf;

use crate::archive::{ArchiveRecord, HistoryArchive};
use crate::digest::Digest;
use crate::document::DocumentVersion;
use crate::document_key::DocumentKey;
use crate::error::Error;
use crate::history::HistoryEntry;
use crate::history_projection::HistoryProjection;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::meta::Meta;
use crate::model::{Effect, Operation, is_among};
use crate::track_id_counter;
use crate::view_record::{ViewMetadata, ViewParts};
use crate::watermark::WatermarkRecord;

/// Intact records, grouped by kind.
#[derive(Default)]
pub(crate) struct RecoveredRecords {
    pub(crate) migrated_from: Option<u32>,
    pub(crate) memory_id: u128,
    pub(crate) next_track_id: u64,
    /// Extent of the archived history.
    pub(crate) archived: ArchiveRecord,
    /// Content that the archived entries imply.
    pub(crate) base: HistoryProjection,
    /// Sequence numbers of archived entries that are damaged or missing.
    lost_in_archive: BTreeSet<u64>,
    /// Intact entries after the archived ones.
    pub(crate) history: BTreeMap<u64, HistoryEntry>,
    /// Content digests of the views with intact metadata and descriptor.
    pub(crate) views: BTreeMap<ViewId, Digest>,
    pub(crate) metadata: BTreeMap<Digest, ViewMetadata>,
    pub(crate) registers: BTreeMap<ViewId, LwwRegister>,
    pub(crate) documents: BTreeMap<(DocumentKey, u64), DocumentVersion>,
    /// Times at which purged views were forgotten, nanoseconds since 1970, UTC.
    pub(crate) tombstones: BTreeMap<Digest, u64>,
    /// Views that were stored and not purged, according to the intact history entries.
    pub(crate) stored_by_history: BTreeSet<ViewId>,
    pub(crate) versions_by_history: BTreeSet<(DocumentKey, u64)>,
    /// Number of views before the damage, as far as it is known.
    pub(crate) n_views_expected: u64,
    /// Sequence number of the last acknowledged entry, as far as it is known.
    pub(crate) last_sequence: u64,
    /// Views whose records are here although the history purged them.
    purged: BTreeSet<ViewId>,
    /// Greatest track-id of the views in the history.
    last_used_track_id: u64,
    /// Ranges of entries that an earlier rebuild recorded as lost.
    known_lost: Vec<(u64, u64)>,
    /// Content converted from an older schema, by digest.
    pub(crate) converted: BTreeMap<Digest, Vec<u8>>,
}

/// Recorded totals of the store, from its metadata record or the watermark.
pub(crate) struct RecordedTotals {
    pub(crate) memory_id: Option<u128>,
    pub(crate) next_track_id: u64,
    pub(crate) sequence: u64,
    pub(crate) n_views: u64,
}

impl RecoveredRecords {
    /// Derives counters and totals from the intact records.
    pub(crate) fn derive_totals(
        &mut self,
        counts: Option<&RecordedTotals>,
        mark: Option<&WatermarkRecord>,
    ) -> Result<(), Error> {
        let purged = &self.purged;
        self.views.retain(|view, _| !purged.contains(view));
        let mut known = self.stored_by_history.clone();
        known.extend(self.views.keys());
        let registered = self.registers.keys();
        known.extend(registered.filter(|view| !purged.contains(view)));
        let marked = mark.map(|mark| RecordedTotals {
            memory_id: Some(mark.memory_id),
            next_track_id: mark.next_track_id,
            sequence: mark.sequence,
            n_views: mark.n_views,
        });
        let totals = counts.into_iter().chain(&marked);
        let newest = totals.clone().max_by_key(|totals| totals.sequence);
        let n_recorded = newest.map_or(0, |newest| newest.n_views);
        self.n_views_expected = n_recorded.max(known.len() as u64);
        let last_recovered = self.history.keys().next_back().copied();
        let last_recovered = last_recovered.unwrap_or(self.archived.sequence);
        let last_recorded = totals
            .clone()
            .map(|totals| totals.sequence)
            .max()
            .unwrap_or(0);
        self.last_sequence = last_recovered.max(last_recorded);
        let recorded = totals.clone().map(|totals| totals.next_track_id);
        let used = known.iter().map(|view| view.track_id);
        let used = used.chain(std::iter::once(self.last_used_track_id));
        self.next_track_id = track_id_counter::recovered(recorded, used);
        self.memory_id = match totals.clone().find_map(|totals| totals.memory_id) {
            Some(memory_id) => memory_id,
            None => Meta::new(None, 1)?.memory_id(),
        };
        Ok(())
    }

    /// Reads the archived entries, then projects the intact ones behind them.
    pub(crate) fn read_history(&mut self, archive: &HistoryArchive) {
        self.archived.clone_from(&archive.record);
        self.known_lost.clone_from(&archive.record.lost);
        let mut projection = HistoryProjection::default();
        let mut lost = BTreeSet::new();
        archive.visit(
            |entry, _| {
                projection.apply(&entry);
                self.note_entry(&entry);
            },
            |_, damaged| lost.extend(damaged),
        );
        self.lost_in_archive = lost;
        self.base = projection.clone();
        // After a crash the last archived entries may still be in the database.
        let history = self.history.split_off(&(self.archived.sequence + 1));
        for entry in history.values() {
            projection.apply(entry);
            self.note_entry(entry);
        }
        self.history = history;
        self.stored_by_history = projection.views.into_keys().collect();
        self.versions_by_history = projection.versions.into_keys().collect();
    }

    /// Notes the used track-ids of an entry, the records of views that it purged, and the entries
    /// that it gives as lost.
    fn note_entry(&mut self, entry: &HistoryEntry) {
        if let Operation::Rebuild { lost, .. } = &entry.operation {
            self.known_lost.extend(lost);
        }
        for effect in &entry.effects {
            let used = effect.view().map_or(0, |view| view.track_id);
            self.last_used_track_id = self.last_used_track_id.max(used);
            match effect {
                Effect::Purged { view }
                    if self.views.contains_key(view) || self.registers.contains_key(view) =>
                {
                    self.purged.insert(*view);
                }
                Effect::Stored { view, .. } => {
                    self.purged.remove(view);
                }
                _ => {}
            }
        }
    }

    /// Ranges of entries that are newly found to be lost.
    pub(crate) fn lost_entries(&self, last_whole: u64) -> Vec<(u64, u64)> {
        let mut lost: Vec<(u64, u64)> = Vec::new();
        let last = self.last_sequence.max(last_whole);
        let recent = self.archived.sequence + 1..=last;
        let missing = recent.filter(|sequence| !self.history.contains_key(sequence));
        for sequence in self.lost_in_archive.iter().copied().chain(missing) {
            if is_among(&self.known_lost, sequence) {
                continue;
            }
            match lost.last_mut() {
                Some((_, last)) if *last + 1 == sequence => *last = sequence,
                _ => lost.push((sequence, sequence)),
            }
        }
        lost
    }

    /// Parts of a view with intact metadata and descriptor; without the point cloud if that is
    /// damaged.
    pub(crate) fn parts(&self, raw: &RawDatabase, identity: Digest) -> Option<ViewParts> {
        let metadata = self.metadata.get(&identity)?.clone();
        let descriptor = self.content(raw, keys::DESCRIPTOR, metadata.descriptor.digest)?;
        let points = metadata
            .points
            .and_then(|points| self.blob(raw, points.digest));
        Some(ViewParts {
            metadata,
            descriptor,
            points,
        })
    }

    /// Intact point cloud or document content, by digest.
    pub(crate) fn blob(&self, raw: &RawDatabase, digest: Digest) -> Option<Vec<u8>> {
        self.content(raw, keys::BLOB, digest)
    }

    fn content(&self, raw: &RawDatabase, table: u8, digest: Digest) -> Option<Vec<u8>> {
        if let Some(converted) = self.converted.get(&digest) {
            return Some(converted.clone());
        }
        let key = keys::digest_key(table, digest);
        let content = unseal::<ByteBuf>(&key, &raw.get(&key)?).ok()?;
        Some(content.into_vec())
    }

    /// Label status of a view and its decision stamp, from the recovered register.
    pub(crate) fn standing(&self, view: ViewId) -> Option<(LabelStatus, DecisionStamp)> {
        let register = self.registers.get(&view)?;
        Some((register.standing.clone(), register.decided.clone()))
    }
}
