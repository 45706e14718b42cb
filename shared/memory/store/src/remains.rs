//! What is whole in the files of a database: its records, in order, and what they
//! say about those that are not.

use std::collections::{BTreeMap, BTreeSet};

use learning::ViewId;
use serde_bytes::ByteBuf;

use crate::digest::Digest;
use crate::document::{DocumentKey, DocumentVersion};
use crate::error::Error;
use crate::examination::schema_of;
use crate::facts::{Facts, ViewParts};
use crate::fold::Fold;
use crate::history::{Effect, HistoryEntry, is_among};
use crate::keys;
use crate::meta::{Meta, SCHEMA};
use crate::raw_database::RawDatabase;
use crate::record::unseal;
use crate::schema_1;
use crate::standing::{Decided, Register, Standing};
use crate::track_id_counter;
use crate::watermark::Mark;

/// Whole records, by what they are about.
#[derive(Default)]
pub(crate) struct Remains {
    pub(crate) migrated_from: Option<u32>,
    pub(crate) memory_id: u128,
    pub(crate) next_track_id: u64,
    pub(crate) history: BTreeMap<u64, HistoryEntry>,
    /// Identities of the views of which facts and descriptor are whole.
    pub(crate) views: BTreeMap<ViewId, Digest>,
    pub(crate) facts: BTreeMap<Digest, Facts>,
    pub(crate) registers: BTreeMap<ViewId, Register>,
    pub(crate) documents: BTreeMap<(DocumentKey, u64), DocumentVersion>,
    pub(crate) tombstones: BTreeMap<Digest, Decided>,
    /// Views that were stored and not purged, by the whole entries of the history.
    pub(crate) stored_by_history: BTreeSet<ViewId>,
    pub(crate) versions_by_history: BTreeSet<(DocumentKey, u64)>,
    /// How many views were there, as far as can be told.
    pub(crate) n_views_expected: u64,
    /// The last entry that was acknowledged, as far as can be told.
    pub(crate) last_sequence: u64,
    /// Entries of which an earlier rebuilding says that they are lost.
    known_lost: Vec<(u64, u64)>,
    /// Content that is not in the files in this form.
    pub(crate) converted: BTreeMap<Digest, Vec<u8>>,
}

/// What is known of the store as a whole, from its record or the watermark.
pub(crate) struct Counts {
    pub(crate) memory_id: Option<u128>,
    pub(crate) next_track_id: u64,
    pub(crate) sequence: u64,
    pub(crate) n_views: u64,
}

impl Remains {
    /// Reads the records; none when there is not one.
    ///
    /// # Errors
    ///
    /// [`Error::NewerSchema`].
    pub(crate) fn find(raw: &RawDatabase, mark: Option<&Mark>) -> Result<Option<Self>, Error> {
        let record = raw.get(&[keys::META]);
        let told = record.as_deref().map_or(Ok(None), schema_of)?;
        let Some(schema) = told.or(raw.version().map(u32::from)) else {
            return Ok(None);
        };
        if schema > SCHEMA {
            return Err(Error::NewerSchema {
                found: schema,
                known: SCHEMA,
            });
        }
        let mut remains = Self::default();
        let counts = if schema == SCHEMA {
            remains.read_records(raw);
            let meta = record.and_then(|record| unseal::<Meta>(&[keys::META], &record).ok());
            meta.map(|meta| Counts {
                memory_id: Some(meta.memory_id()),
                next_track_id: meta.next_track_id,
                sequence: meta.sequence,
                n_views: meta.n_views,
            })
        } else {
            remains.migrated_from = Some(schema);
            schema_1::read_records(raw, &mut remains)
        };
        remains.sum_up(counts.as_ref(), mark)?;
        Ok(Some(remains))
    }

    fn read_records(&mut self, raw: &RawDatabase) {
        for (key, record) in raw.table(keys::HISTORY) {
            if let Some(sequence) = keys::sequence_of(key)
                && let Ok((entry, _)) = HistoryEntry::unseal(sequence, &record)
            {
                self.history.insert(sequence, entry);
            }
        }
        for (key, record) in raw.table(keys::VIEW) {
            if let Some(view) = keys::view_of(key)
                && let Ok(facts) = unseal::<Facts>(key, &record)
                && raw.contains(&keys::digest_key(keys::DESCRIPTOR, facts.descriptor.digest))
            {
                let identity = facts.identity();
                self.views.insert(view, identity);
                self.facts.insert(identity, facts);
            }
        }
        for (key, record) in raw.table(keys::REGISTER) {
            if let (Some(view), Ok(register)) = (keys::view_of(key), unseal(key, &record)) {
                self.registers.insert(view, register);
            }
        }
        for (key, record) in raw.table(keys::DOCUMENT) {
            if let (Some(version), Ok(content)) = (keys::document_of(key), unseal(key, &record)) {
                self.documents.insert(version, content);
            }
        }
        for (key, record) in raw.table(keys::TOMBSTONE) {
            if let (Some(identity), Ok(decided)) = (keys::digest_of(key), unseal(key, &record)) {
                self.tombstones.insert(identity, decided);
            }
        }
    }

    /// What the records say about the whole.
    fn sum_up(&mut self, counts: Option<&Counts>, mark: Option<&Mark>) -> Result<(), Error> {
        let purged = self.fold_history();
        self.views.retain(|view, _| !purged.contains(view));
        let mut known = self.stored_by_history.clone();
        known.extend(self.views.keys());
        let registered = self.registers.keys();
        known.extend(registered.filter(|view| !purged.contains(view)));
        let marked = mark.map(|mark| Counts {
            memory_id: Some(mark.memory_id),
            next_track_id: mark.next_track_id,
            sequence: mark.sequence,
            n_views: mark.n_views,
        });
        let told = counts.into_iter().chain(&marked);
        let newest = told.clone().max_by_key(|told| told.sequence);
        let n_told = newest.map_or(0, |newest| newest.n_views);
        self.n_views_expected = n_told.max(known.len() as u64);
        let last_met = self.history.keys().next_back().copied().unwrap_or(0);
        let last_told = told.clone().map(|told| told.sequence).max().unwrap_or(0);
        self.last_sequence = last_met.max(last_told);
        let recorded = told.clone().map(|told| told.next_track_id);
        let used = known.iter().chain(&purged).map(|view| view.track_id);
        self.next_track_id = track_id_counter::recovered(recorded, used);
        self.memory_id = match told.clone().find_map(|told| told.memory_id) {
            Some(memory_id) => memory_id,
            None => Meta::new(None, 1)?.memory_id(),
        };
        Ok(())
    }

    /// Notes what the whole entries say; returns the views they purged for good.
    fn fold_history(&mut self) -> BTreeSet<ViewId> {
        let mut fold = Fold::default();
        let mut purged = BTreeSet::new();
        for entry in self.history.values() {
            fold.apply(entry, Digest::default());
            for effect in &entry.effects {
                match effect {
                    Effect::Purged { view } => {
                        purged.insert(*view);
                    }
                    Effect::Stored { view, .. } => {
                        purged.remove(view);
                    }
                    _ => {}
                }
            }
        }
        self.stored_by_history = fold.views.keys().copied().collect();
        self.known_lost = fold.lost().to_vec();
        self.versions_by_history = fold.into_versions();
        purged
    }

    /// First and last sequence of entries that are lost and were not told yet.
    pub(crate) fn lost_entries(&self, last_whole: u64) -> Vec<(u64, u64)> {
        let mut lost: Vec<(u64, u64)> = Vec::new();
        for sequence in 1..=self.last_sequence.max(last_whole) {
            if self.history.contains_key(&sequence) || is_among(&self.known_lost, sequence) {
                continue;
            }
            match lost.last_mut() {
                Some((_, last)) if *last + 1 == sequence => *last = sequence,
                _ => lost.push((sequence, sequence)),
            }
        }
        lost
    }

    /// The parts of a view of which facts and descriptor are whole; without its
    /// cloud when that is not.
    pub(crate) fn parts(&self, raw: &RawDatabase, identity: Digest) -> Option<ViewParts> {
        let facts = self.facts.get(&identity)?.clone();
        let descriptor = self.content(raw, keys::DESCRIPTOR, facts.descriptor.digest)?;
        let points = facts
            .points
            .and_then(|points| self.blob(raw, points.digest));
        Some(ViewParts {
            facts,
            descriptor,
            points,
        })
    }

    /// A cloud or the content of a document.
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

    /// What a view stands for by its register, and who decided that.
    pub(crate) fn standing(&self, view: ViewId) -> Option<(Standing, Decided)> {
        let register = self.registers.get(&view)?;
        Some((register.standing.clone(), register.decided.clone()))
    }
}
