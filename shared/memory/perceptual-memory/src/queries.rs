//! Read queries on the perceptual memory: snapshot pages, change feed, history, documents.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use durable_leveldb::{Reader, record::unseal};
use learning::{CategoryName, ViewId};
use serde_bytes::ByteBuf;
use unicode_text::likeness;

use crate::digest::Digest;
use crate::document::{DocumentContent, DocumentRevision, DocumentSummary, MemoryDocument};
use crate::document_key::DocumentKey;
use crate::error::{Error, StoreRefusal};
use crate::history::HistoryEntry;
use crate::index_row::IndexedView;
use crate::keys;
use crate::meta::StoreId;
use crate::model::Effect;
use crate::perceptual_memory::PerceptualMemory;
use crate::record_reader::{read_content, read_entry, read_view};
use crate::store_index::{CategorySummary, StoreIndex};
use crate::view::{StoredDescriptor, StoredView};
use crate::view_record::{self, ContentRef};

/// Number of unwanted records whose scan costs as much as one seek. Measured with the bench
/// `load_snapshot`.
const SKIPPED_PER_SEEK: usize = 16;

/// Replication position of a reader in the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Position {
    /// Id of the store.
    pub store_id: StoreId,
    /// Sequence number of the last history entry that the reader has applied.
    pub sequence: u64,
}

/// Labelled view, as recognition needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledView {
    /// Id of the view.
    pub view: ViewId,
    /// Category label of the view.
    pub category: CategoryName,
    /// Descriptor of the view.
    pub descriptor: StoredDescriptor,
}

/// Page of a snapshot of all labelled views.
///
/// A reader loads page after page, keeps the position of the *first* page, and then requests the
/// changes since that position. Changes that a later page contains already are applied twice, which
/// has no effect.
#[derive(Debug, Clone, PartialEq)]
pub struct SnapshotPage {
    /// State of the store that the page shows.
    pub position: Position,
    /// Labelled views, ordered by the digest of their descriptors.
    pub views: Vec<LabelledView>,
    /// Cursor of the next page; `None` after the last page.
    pub next: Option<Digest>,
}

/// Change feed: label changes since a position.
#[derive(Debug, Clone, PartialEq)]
pub enum Changes {
    /// History entries after the position, without a gap.
    Entries {
        /// Entries in order; empty when nothing changed.
        entries: Vec<ChangeEntry>,
        /// Sequence number of the last history entry. Request again until it is reached.
        last_sequence: u64,
    },
    /// Position of another store, or before the archived part of the history: load a new snapshot.
    Reload,
}

/// Label changes of one history entry.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangeEntry {
    /// Sequence number of the history entry.
    pub sequence: u64,
    /// Label changes; empty for an entry that only stored views.
    pub names: Vec<NameChange>,
}

/// Label change of one view.
#[derive(Debug, Clone, PartialEq)]
pub enum NameChange {
    /// New label of a view, which replaces any earlier one.
    Assigned(LabelledView),
    /// View that lost its label.
    Unassigned(ViewId),
}

impl PerceptualMemory {
    /// Replication position at the end of the store's history.
    pub fn position(&self) -> Position {
        Position {
            store_id: self.store_id(),
            sequence: self.sequence(),
        }
    }

    /// Size of every category, ordered by name.
    pub fn categories(&self) -> Vec<CategorySummary> {
        self.index.summaries()
    }

    /// Number of categories whose stored name is not the one that they would be given today.
    pub fn n_names_to_normalise(&self) -> usize {
        let is_other = |name: &&CategoryName| name.normalised() != **name;
        self.index.names().filter(is_other).count()
    }

    /// Refusal of the first of these names that would be a new category beside one with a name
    /// like it, stored or among them.
    ///
    /// # Errors
    ///
    /// [`StoreRefusal::NameAlike`].
    pub fn check_new_names(&self, names: &BTreeSet<CategoryName>) -> Result<(), Error> {
        let is_new = |name: &&CategoryName| self.index.n_views_of(name) == 0;
        for name in names.iter().filter(is_new) {
            let others = self.index.names().chain(names);
            let mut others = others.filter(|other| *other != name);
            let is_alike =
                |other: &&CategoryName| likeness(name.as_str(), other.as_str()).is_some();
            if let Some(existing) = others.find(is_alike) {
                return Err(StoreRefusal::NameAlike {
                    name: name.clone(),
                    existing: existing.clone(),
                }
                .into());
            }
        }
        Ok(())
    }

    /// All views of a track in order of their ids, without forgotten ones; empty for an unknown
    /// track.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn views_of_track(&mut self, track_id: u64) -> Result<Vec<StoredView>, Error> {
        let views: Vec<(ViewId, IndexedView)> = self
            .index
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

    /// Stored point clouds of the first of these views, at least one and no more after
    /// `max_bytes`; an empty cloud where none is kept.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn clouds(&mut self, views: &[ViewId], max_bytes: usize) -> Result<Vec<Vec<u8>>, Error> {
        let points = |view: &ViewId| self.index.get(*view)?.points;
        let wanted: Vec<Option<ContentRef>> = views.iter().map(points).collect();
        self.read(|reader| {
            let (mut clouds, mut n_bytes) = (Vec::new(), 0);
            for points in wanted {
                n_bytes += points.map_or(0, |points| points.n_bytes as usize);
                if n_bytes > max_bytes && !clouds.is_empty() {
                    break;
                }
                clouds.push(match points {
                    Some(points) => {
                        read_content(reader, &keys::digest_key(keys::BLOB, points.digest))?
                    }
                    None => Vec::new(),
                });
            }
            Ok(clouds)
        })
    }

    /// Page of labelled views, starting at `cursor` (`None` for the first page). The page ends with
    /// the view whose descriptor exceeds `max_bytes`, so it holds at least one view.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn snapshot(
        &mut self,
        cursor: Option<Digest>,
        max_bytes: usize,
    ) -> Result<SnapshotPage, Error> {
        let position = self.position();
        let (runs, next) = runs_from(&self.index, cursor.unwrap_or_default(), max_bytes);
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

    /// Label changes after `since`, unless entries after it are archived: as many entries as fit
    /// into `max_bytes` of descriptors, at least one.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn changes(&mut self, since: Position, max_bytes: usize) -> Result<Changes, Error> {
        let now = self.position();
        let is_known = (self.archive.record.sequence..=now.sequence).contains(&since.sequence);
        if since.store_id != now.store_id || !is_known {
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

    /// Up to `max` history entries from sequence number `from` on, archived or not, without those
    /// lost with a damaged store or dropped for the limit of the archive.
    ///
    /// # Errors
    ///
    /// [`Error::ArchiveDamaged`],
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn history(&mut self, from: u64, max: usize) -> Result<Vec<HistoryEntry>, Error> {
        let first = from.max(self.archive.record.dropped + 1);
        let sequences = (first..=self.sequence())
            .filter(|sequence| !self.index.is_lost(*sequence))
            .take(max);
        self.entries(sequences.collect())
    }

    /// All documents, without their content.
    pub fn documents(&self) -> Vec<DocumentSummary> {
        self.index.documents().collect()
    }

    /// Present version of a document, without its content.
    ///
    /// # Errors
    ///
    /// [`StoreRefusal::UnknownDocument`] when there is none, or it was removed.
    pub fn document_summary(&self, key: &DocumentKey) -> Result<DocumentSummary, StoreRefusal> {
        let summary = self.index.document_summary(key);
        summary.ok_or_else(|| StoreRefusal::UnknownDocument {
            document: key.clone(),
        })
    }

    /// Versions of a document that are not purged, oldest first; the last one is the present one.
    ///
    /// # Errors
    ///
    /// [`StoreRefusal::UnknownDocument`] when there is none.
    pub fn document_versions(
        &self,
        key: &DocumentKey,
    ) -> Result<Vec<DocumentRevision>, StoreRefusal> {
        let versions: Vec<_> = self.index.document_revisions(key).collect();
        if versions.is_empty() {
            let document = key.clone();
            return Err(StoreRefusal::UnknownDocument { document });
        }
        Ok(versions)
    }

    /// Reads the content of a document version.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn document_content(&mut self, content: &DocumentContent) -> Result<Vec<u8>, Error> {
        let key = keys::digest_key(keys::BLOB, content.digest);
        self.read(|reader| read_content(reader, &key))
    }

    /// Reads a document with its content.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`] when there is none,
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn document(&mut self, key: &DocumentKey) -> Result<MemoryDocument, Error> {
        let DocumentSummary { key, content, .. } = self.document_summary(key)?;
        Ok(MemoryDocument {
            key,
            content: self.document_content(&content)?,
            media_type: content.media_type,
        })
    }

    /// Label changes of one history entry.
    fn change(&mut self, sequence: u64) -> Result<ChangeEntry, Error> {
        let entry = self.read(|reader| read_entry(reader, sequence))?;
        let name = |effect| match effect {
            Effect::Changed { view, after, .. } => Some((view, after.category().cloned())),
            Effect::Purged { view } => Some((view, None)),
            _ => None,
        };
        let named: Vec<(ViewId, Option<CategoryName>)> =
            entry.effects.into_iter().filter_map(name).collect();
        // A view purged later has no content; a later entry reports its removal.
        let known: Vec<_> = named
            .into_iter()
            .map(|(view, after)| (view, after.zip(self.index.get(view).cloned())))
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

/// Labelled views with neighbouring descriptor records, read with one scan.
type DescriptorRun = Vec<(Digest, Vec<(ViewId, CategoryName, String)>)>;

/// Descriptor runs of a page, and the cursor of the next page.
fn runs_from(
    index: &StoreIndex,
    from: Digest,
    max_bytes: usize,
) -> (Vec<DescriptorRun>, Option<Digest>) {
    let mut n_bytes = 0;
    let mut n_skipped = 0;
    let mut runs: Vec<DescriptorRun> = vec![Vec::new()];
    for (digest, views) in index.descriptors_from(from) {
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

fn read_labelled(
    reader: &Reader,
    view: ViewId,
    category: CategoryName,
    entry: &IndexedView,
) -> Result<LabelledView, Error> {
    let key = keys::digest_key(keys::DESCRIPTOR, entry.descriptor.digest);
    let values = read_content(reader, &key)?;
    Ok(LabelledView {
        view,
        category,
        descriptor: view_record::descriptor(entry.descriptor_kind.to_string(), &values),
    })
}

/// Reads a run of neighbouring descriptor records in key order.
fn read_run(
    reader: &Reader,
    run: DescriptorRun,
    views: &mut Vec<LabelledView>,
) -> Result<(), Error> {
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
                        descriptor: view_record::descriptor(kind, &values),
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
        Some((digest, wrong)) => Err(keys::record_error(
            &keys::digest_key(keys::DESCRIPTOR, digest),
            wrong,
        )),
        None => Ok(()),
    }
}
