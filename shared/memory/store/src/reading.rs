//! What the perceptual memory can be asked.

use std::ops::ControlFlow;

use learning::{CategoryName, ViewId};
use serde::de::DeserializeOwned;
use serde_bytes::ByteBuf;

use crate::catalogue::{Catalogue, CategorySummary, Entry};
use crate::digest::Digest;
use crate::document::{Document, DocumentKey, DocumentSummary};
use crate::engine::Reader;
use crate::error::{Error, Refusal};
use crate::facts::{self, Facts, ViewParts};
use crate::history::{Effect, HistoryEntry};
use crate::keys;
use crate::meta::StoreId;
use crate::perceptual_memory::PerceptualMemory;
use crate::record::unseal;
use crate::view::{Descriptor, StoredView};

/// Unwanted records passed by in the time of one seek; see the bench `load_snapshot`.
const SKIPPED_PER_SEEK: usize = 16;

/// How far a reader has followed a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Position {
    /// Which store.
    pub store_id: StoreId,
    /// The last history entry the reader knows.
    pub sequence: u64,
}

/// A view as recognition needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledView {
    /// Which view.
    pub view: ViewId,
    /// What it is called.
    pub category: CategoryName,
    /// What to compare with.
    pub descriptor: Descriptor,
}

/// A part of all labelled views.
///
/// A reader loads page after page, notes the position of the *first*, and then
/// asks for the changes since that. A change that a later page shows already is
/// then applied once more, which alters nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct SnapshotPage {
    /// The state the page shows.
    pub position: Position,
    /// Labelled views, in the order of their descriptors' digests.
    pub views: Vec<LabelledView>,
    /// Where the next page begins; none after the last one.
    pub next: Option<Digest>,
}

/// What changed since a position.
#[derive(Debug, Clone, PartialEq)]
pub enum Changes {
    /// The entries that follow the position, without a gap.
    Entries {
        /// In order; empty when nothing changed.
        entries: Vec<ChangeEntry>,
        /// Sequence of the last entry there is; ask again until it is reached.
        last_sequence: u64,
    },
    /// The position is not one of this store: load the snapshot again.
    Reload,
}

/// One history entry's effect on the names of views.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangeEntry {
    /// Its sequence.
    pub sequence: u64,
    /// Its effects; none when it only stored views.
    pub names: Vec<NameChange>,
}

/// A change of a view's name.
#[derive(Debug, Clone, PartialEq)]
pub enum NameChange {
    /// The view now has this name, and no other.
    Assigned(LabelledView),
    /// The view now has none.
    Unassigned(ViewId),
}

impl PerceptualMemory {
    /// Where the store is now.
    pub fn position(&self) -> Position {
        Position {
            store_id: self.store_id(),
            sequence: self.sequence(),
        }
    }

    /// All categories with their sizes, by name.
    pub fn categories(&self) -> Vec<CategorySummary> {
        self.catalogue.summaries()
    }

    /// Everything stored of a track, in order of the views, without those that are
    /// forgotten; empty for an unknown track.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn views_of_track(&mut self, track_id: u64) -> Result<Vec<StoredView>, Error> {
        let views: Vec<(ViewId, Entry)> = self
            .catalogue
            .track(track_id)
            .map(|(view, entry)| (view, entry.clone()))
            .collect();
        self.read(|reader| {
            views
                .iter()
                .map(|(view, entry)| read_view(reader, *view, entry))
                .collect()
        })
    }

    /// The page of labelled views from `cursor` on: none for the first, then what
    /// the page before gave as next. Ends with the view that makes its descriptors
    /// exceed `max_bytes`, so it has at least one view.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn snapshot(
        &mut self,
        cursor: Option<Digest>,
        max_bytes: usize,
    ) -> Result<SnapshotPage, Error> {
        let position = self.position();
        let (runs, next) = runs_from(&self.catalogue, cursor.unwrap_or_default(), max_bytes);
        let views = self.read(|reader| {
            let mut views = Vec::new();
            runs.into_iter()
                .try_for_each(|run| read_run(reader, run, &mut views))?;
            Ok(views)
        })?;
        Ok(SnapshotPage {
            position,
            views,
            next,
        })
    }

    /// The changes of names after `since`, as many as fit `max_bytes` of
    /// descriptors, and at least one.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn changes(&mut self, since: Position, max_bytes: usize) -> Result<Changes, Error> {
        let now = self.position();
        if since.store_id != now.store_id || since.sequence > now.sequence {
            return Ok(Changes::Reload);
        }
        let mut entries = Vec::new();
        let mut n_bytes = 0;
        let mut sequence = since.sequence;
        while sequence < now.sequence && (entries.is_empty() || n_bytes <= max_bytes) {
            sequence += 1;
            let entry = self.change(sequence)?;
            let size = |change: &NameChange| match change {
                NameChange::Assigned(view) => 4 * view.descriptor.values.len(),
                NameChange::Unassigned(_) => 0,
            };
            n_bytes += entry.names.iter().map(size).sum::<usize>();
            entries.push(entry);
        }
        Ok(Changes::Entries {
            entries,
            last_sequence: now.sequence,
        })
    }

    /// Up to `max` entries of the history from sequence `from` on; those that a
    /// damaged store has lost are left out.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn history(&mut self, from: u64, max: usize) -> Result<Vec<HistoryEntry>, Error> {
        let sequences: Vec<u64> = (from.max(1)..=self.sequence())
            .filter(|sequence| !self.catalogue.is_lost(*sequence))
            .take(max)
            .collect();
        self.read(|reader| {
            sequences
                .into_iter()
                .map(|sequence| read_entry(reader, sequence))
                .collect()
        })
    }

    /// All documents, without their content.
    pub fn documents(&self) -> Vec<DocumentSummary> {
        self.catalogue.documents().collect()
    }

    /// A document.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] when there is none, [`Error::Damaged`] or [`Error::Failed`].
    pub fn document(&mut self, key: &DocumentKey) -> Result<Document, Error> {
        let present = self.catalogue.document(key);
        let Some(content) = present.and_then(|(_, version)| version.content.clone()) else {
            let document = key.clone();
            return Err(Refusal::UnknownDocument { document }.into());
        };
        let bytes = self
            .read(|reader| read_content(reader, &keys::digest_key(keys::BLOB, content.digest)))?;
        Ok(Document {
            key: key.clone(),
            media_type: content.media_type,
            content: bytes,
        })
    }

    /// One history entry's effect on names.
    fn change(&mut self, sequence: u64) -> Result<ChangeEntry, Error> {
        let entry = self.read(|reader| read_entry(reader, sequence))?;
        let name = |effect| match effect {
            Effect::Changed { view, after, .. } => Some((view, after.category().cloned())),
            Effect::Purged { view } => Some((view, None)),
            _ => None,
        };
        let named: Vec<(ViewId, Option<CategoryName>)> =
            entry.effects.into_iter().filter_map(name).collect();
        // What was purged since has no content any more; a later entry says so.
        let known: Vec<_> = named
            .into_iter()
            .map(|(view, after)| (view, after.zip(self.catalogue.get(view).cloned())))
            .collect();
        let names = self.read(|reader| {
            let name = |(view, after)| match after {
                Some((category, entry)) => Ok(NameChange::Assigned(read_labelled(
                    reader, view, category, &entry,
                )?)),
                None => Ok(NameChange::Unassigned(view)),
            };
            known.into_iter().map(name).collect()
        })?;
        Ok(ChangeEntry { sequence, names })
    }
}

/// Named views with descriptors that lie close together, by their content.
type Run = Vec<(Digest, Vec<(ViewId, CategoryName, String)>)>;

/// What belongs to a page, and where the next begins.
fn runs_from(catalogue: &Catalogue, from: Digest, max_bytes: usize) -> (Vec<Run>, Option<Digest>) {
    let mut n_bytes = 0;
    let mut n_skipped = 0;
    let mut runs: Vec<Run> = vec![Vec::new()];
    for (digest, views) in catalogue.descriptors_from(from) {
        let mut size = 0;
        let mut named = Vec::new();
        for (view, entry) in views {
            if let Some(name) = entry.register.standing.category() {
                named.push((view, name.clone(), entry.descriptor_kind.to_string()));
                size += entry.descriptor.n_bytes as usize;
            }
        }
        if named.is_empty() {
            n_skipped += 1;
            continue;
        }
        if n_bytes > max_bytes {
            return (runs, Some(digest));
        }
        n_bytes += size;
        if std::mem::take(&mut n_skipped) > SKIPPED_PER_SEEK {
            runs.push(Vec::new());
        }
        if let Some(run) = runs.last_mut() {
            run.push((digest, named));
        }
    }
    (runs, None)
}

/// Reads a record that must be there.
pub(crate) fn read_record<T: DeserializeOwned>(
    reader: &mut Reader,
    key: &[u8],
) -> Result<T, Error> {
    let record = reader.get(key)?;
    let value = record
        .ok_or("it is missing")
        .and_then(|record| unseal(key, &record));
    value.map_err(|wrong| Error::record(key, wrong))
}

/// Reads content that must be there and be what its digest says.
pub(crate) fn read_content(reader: &mut Reader, key: &[u8]) -> Result<Vec<u8>, Error> {
    Ok(read_record::<ByteBuf>(reader, key)?.into_vec())
}

fn read_labelled(
    reader: &mut Reader,
    view: ViewId,
    category: CategoryName,
    entry: &Entry,
) -> Result<LabelledView, Error> {
    let key = keys::digest_key(keys::DESCRIPTOR, entry.descriptor.digest);
    let values = read_content(reader, &key)?;
    Ok(LabelledView {
        view,
        category,
        descriptor: facts::descriptor(entry.descriptor_kind.to_string(), &values),
    })
}

/// Reads descriptors that lie close together, in the order of their keys.
fn read_run(reader: &mut Reader, run: Run, views: &mut Vec<LabelledView>) -> Result<(), Error> {
    let Some((first, _)) = run.first() else {
        return Ok(());
    };
    let first = keys::digest_key(keys::DESCRIPTOR, *first);
    let mut wanted = run.into_iter().peekable();
    let mut damaged = None;
    reader.scan(&first, |key, record| {
        let is_here =
            |(digest, _): &(Digest, _)| keys::digest_key(keys::DESCRIPTOR, *digest) == key;
        if let Some((digest, named)) = wanted.next_if(is_here) {
            match unseal::<ByteBuf>(key, record) {
                Ok(values) => {
                    let view = |(view, category, kind)| LabelledView {
                        view,
                        category,
                        descriptor: facts::descriptor(kind, &values),
                    };
                    views.extend(named.into_iter().map(view));
                }
                Err(wrong) => {
                    damaged = Some((digest, wrong));
                    return ControlFlow::Break(());
                }
            }
        }
        let is_before =
            |(digest, _): &(Digest, _)| &keys::digest_key(keys::DESCRIPTOR, *digest)[..] > key;
        if wanted.peek().is_some_and(is_before) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    })?;
    let missing = wanted.next().map(|(digest, _)| (digest, "it is missing"));
    match damaged.or(missing) {
        Some((digest, wrong)) => Err(Error::record(
            &keys::digest_key(keys::DESCRIPTOR, digest),
            wrong,
        )),
        None => Ok(()),
    }
}

/// Reads an entry that must be there.
pub(crate) fn read_entry(reader: &mut Reader, sequence: u64) -> Result<HistoryEntry, Error> {
    let key = keys::history_key(sequence);
    let record = reader.get(&key)?;
    let entry = record
        .ok_or("it is missing")
        .and_then(|record| HistoryEntry::unseal(sequence, &record));
    Ok(entry.map_err(|wrong| Error::record(&key, wrong))?.0)
}

/// Reads all parts of a view that must be there.
pub(crate) fn read_parts(reader: &mut Reader, view: ViewId) -> Result<ViewParts, Error> {
    let facts = read_record::<Facts>(reader, &keys::view_key(keys::VIEW, view))?;
    let key = keys::digest_key(keys::DESCRIPTOR, facts.descriptor.digest);
    let descriptor = read_content(reader, &key)?;
    let points = match &facts.points {
        Some(points) => Some(read_content(
            reader,
            &keys::digest_key(keys::BLOB, points.digest),
        )?),
        None => None,
    };
    Ok(ViewParts {
        facts,
        descriptor,
        points,
    })
}

/// Reads a view, with what it stands for by the index.
pub(crate) fn read_view(
    reader: &mut Reader,
    view: ViewId,
    entry: &Entry,
) -> Result<StoredView, Error> {
    let parts = read_parts(reader, view)?;
    let register = &entry.register;
    let is_decided = register.decided.stamp_ns > 0;
    Ok(StoredView {
        origin: parts.facts.origin(),
        view: parts.into_view(view),
        standing: register.standing.clone(),
        decided: is_decided.then(|| register.decided.clone()),
        sequence: register.sequence,
    })
}
