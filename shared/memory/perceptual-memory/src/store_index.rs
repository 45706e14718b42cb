//! In-memory index of the store: views with their label status, answered mutations, documents.
//! Descriptors, point clouds and document content stay on disk.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Bound;
use std::sync::Arc;

use durable_leveldb::{MutationId, record::seal};
use learning::{CategoryName, ViewId, ViewLabel};

use crate::digest::Digest;
use crate::document::{DocumentRevision, DocumentSummary, DocumentVersion};
use crate::document_key::DocumentKey;
use crate::index_loading::DigestedRow;
use crate::index_row::IndexedView;
use crate::keys;
use crate::label_status::{LabelStatus, LwwRegister};
use crate::model::is_among;
use crate::set_digest::{SetDigest, record_digest};
use crate::tombstone;
use crate::view::Origin;

/// Statistics of a learned category.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CategorySummary {
    /// Name of the category.
    pub name: CategoryName,
    /// Number of the category's views, at least one.
    pub n_views: u64,
    /// Total size of the views' descriptors and point clouds, bytes.
    pub n_bytes: u64,
    /// Time of the last labelling, nanoseconds since 1970, UTC.
    pub last_taught_ns: u64,
}

/// In-memory index of the store.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct StoreIndex {
    views: BTreeMap<ViewId, IndexedView>,
    categories: BTreeMap<CategoryName, BTreeSet<ViewId>>,
    n_forgotten: usize,
    identities: HashMap<Digest, ViewId>,
    /// Number of views by memory and track-id of their origin, and local track-id.
    tracks_of_origins: BTreeMap<(u128, u64, u64), u32>,
    /// Views by the digest of their descriptor (deduplication).
    descriptors: BTreeSet<(Digest, ViewId)>,
    /// Reference counts of point clouds and document content, by digest.
    blobs: HashMap<Digest, u32>,
    documents: BTreeMap<DocumentKey, BTreeMap<u64, DocumentVersion>>,
    /// Times at which purged views were forgotten, nanoseconds since 1970, UTC.
    tombstones: BTreeMap<Digest, u64>,
    /// Sequence numbers of answered mutations that are not archived, by idempotency key.
    pub(crate) answered: HashMap<MutationId, u64>,
    kinds: BTreeSet<Arc<str>>,
    /// Digest of all records that the index was made of.
    records: SetDigest,
    /// First and last sequence numbers of the entries lost with a damaged store.
    lost: Vec<(u64, u64)>,
}

/// Lost history entries.
impl StoreIndex {
    /// Ranges of lost entries, in order and apart from each other.
    pub(crate) fn lost(&self) -> &[(u64, u64)] {
        &self.lost
    }

    /// Adds ranges of lost entries, which may be known already.
    pub(crate) fn add_lost(&mut self, ranges: &[(u64, u64)]) {
        let mut all = std::mem::take(&mut self.lost);
        all.extend(ranges);
        all.sort_unstable();
        for (first, last) in all {
            match self.lost.last_mut() {
                Some((_, end)) if first <= *end + 1 => *end = last.max(*end),
                _ => self.lost.push((first, last)),
            }
        }
    }

    /// `true` if the entry was lost with a damaged store.
    pub(crate) fn is_lost(&self, sequence: u64) -> bool {
        is_among(&self.lost, sequence)
    }

    /// Number of lost history entries.
    pub(crate) fn n_lost(&self) -> u64 {
        self.lost.iter().map(|(first, last)| last - first + 1).sum()
    }
}

/// Queries and updates of views.
impl StoreIndex {
    /// View with content, forgotten or not.
    pub(crate) fn get(&self, view: ViewId) -> Option<&IndexedView> {
        self.views.get(&view)
    }

    /// All indexed views, in id order.
    pub(crate) fn all(&self) -> impl Iterator<Item = (ViewId, &IndexedView)> {
        self.views.iter().map(|(view, entry)| (*view, entry))
    }

    /// Views from a bound on, in id order.
    pub(crate) fn range(
        &self,
        from: Bound<ViewId>,
    ) -> impl Iterator<Item = (ViewId, &IndexedView)> {
        let views = self.views.range((from, Bound::Unbounded));
        views.map(|(view, entry)| (*view, entry))
    }

    pub(crate) fn n_all(&self) -> usize {
        self.views.len()
    }

    pub(crate) fn n_forgotten(&self) -> usize {
        self.n_forgotten
    }

    pub(crate) fn n_named(&self) -> usize {
        self.categories.values().map(BTreeSet::len).sum()
    }

    pub(crate) fn n_unnamed(&self) -> usize {
        self.views.len() - self.n_forgotten - self.n_named()
    }

    pub(crate) fn n_categories(&self) -> usize {
        self.categories.len()
    }

    pub(crate) fn by_identity(&self, identity: Digest) -> Option<(ViewId, &IndexedView)> {
        let view = *self.identities.get(&identity)?;
        Some((view, self.views.get(&view)?))
    }

    /// Local track for a foreign track, and its next view id.
    pub(crate) fn track_of_origin(&self, origin: Origin) -> Option<(u64, u32)> {
        let of_origin = |track_id| (origin.memory_id, origin.view.track_id, track_id);
        let mut tracks = self
            .tracks_of_origins
            .range(of_origin(0)..=of_origin(u64::MAX));
        let (&(.., track_id), _) = tracks.next()?;
        let (last, _) = self.whole_track(track_id).next_back()?;
        Some((track_id, last.view_id.checked_add(1)?))
    }

    /// Views of a track without forgotten ones, in id order.
    pub(crate) fn track(
        &self,
        track_id: u64,
    ) -> impl Iterator<Item = (ViewId, &IndexedView)> + Clone {
        self.whole_track(track_id)
            .filter(|(_, entry)| !entry.is_forgotten())
    }

    fn whole_track(
        &self,
        track_id: u64,
    ) -> impl DoubleEndedIterator<Item = (ViewId, &IndexedView)> + Clone {
        let first = ViewId {
            track_id,
            view_id: 0,
        };
        let last = ViewId {
            track_id,
            view_id: u32::MAX,
        };
        self.views
            .range(first..=last)
            .map(|(view, entry)| (*view, entry))
    }

    /// Views of a track, as input of the rules of teaching.
    pub(crate) fn records_of_track(
        &self,
        track_id: u64,
    ) -> impl Iterator<Item = ViewLabel<'_>> + Clone {
        self.track(track_id).map(|(id, entry)| ViewLabel {
            id,
            category: entry.register.standing.category(),
        })
    }

    /// Views of a category, in id order.
    pub(crate) fn category(
        &self,
        name: &CategoryName,
    ) -> impl Iterator<Item = (ViewId, &IndexedView)> + Clone {
        let name = self.stored_name(name);
        let views = self.categories.get(name).into_iter().flatten();
        views.filter_map(|view| Some((*view, self.views.get(view)?)))
    }

    /// Name under which a category is stored: the name itself, or one of an earlier version that
    /// is this name today. The name itself if there is no such category.
    pub(crate) fn stored_name<'a>(&'a self, name: &'a CategoryName) -> &'a CategoryName {
        if self.categories.contains_key(name) {
            return name;
        }
        let is_of_earlier_version =
            |stored: &&CategoryName| !stored.as_str().is_ascii() && stored.normalised() == *name;
        self.names().find(is_of_earlier_version).unwrap_or(name)
    }

    /// Names of all categories, in order.
    pub(crate) fn names(&self) -> impl Iterator<Item = &CategoryName> {
        self.categories.keys()
    }

    pub(crate) fn n_views_of(&self, name: &CategoryName) -> usize {
        self.categories.get(name).map_or(0, BTreeSet::len)
    }

    /// Categories with more than `n_views` views.
    pub(crate) fn larger_categories(&self, n_views: usize) -> Vec<CategoryName> {
        let larger = self
            .categories
            .iter()
            .filter(|(_, views)| views.len() > n_views);
        larger.map(|(name, _)| name.clone()).collect()
    }

    /// Descriptor digests from `from` on, each with the views that share it.
    pub(crate) fn descriptors_from(
        &self,
        from: Digest,
    ) -> impl Iterator<Item = (Digest, Vec<(ViewId, &IndexedView)>)> {
        let pairs = self.descriptors.range((from, FIRST_VIEW)..);
        let mut pairs = pairs.copied().peekable();
        std::iter::from_fn(move || {
            let (digest, view) = pairs.next()?;
            let mut views = vec![view];
            while let Some((_, view)) = pairs.next_if(|(next, _)| *next == digest) {
                views.push(view);
            }
            let rows = views.into_iter();
            let rows = rows.filter_map(|view| Some((view, self.views.get(&view)?)));
            Some((digest, rows.collect()))
        })
    }

    /// `true` if a view has this descriptor.
    pub(crate) fn has_descriptor(&self, digest: Digest) -> bool {
        let mut views = self.descriptors.range((digest, FIRST_VIEW)..);
        views.next().is_some_and(|(found, _)| *found == digest)
    }

    /// `true` if a view or document has this content.
    pub(crate) fn has_blob(&self, digest: Digest) -> bool {
        self.blobs.contains_key(&digest)
    }

    /// Index of rows in the order of their views, built at once.
    pub(crate) fn of_rows(rows: Vec<DigestedRow>) -> Self {
        let mut index = Self {
            identities: HashMap::with_capacity(rows.len()),
            descriptors: rows
                .iter()
                .map(|(view, row, _)| (row.descriptor.digest, *view))
                .collect(),
            ..Self::default()
        };
        let views = rows.into_iter().map(|(view, mut row, record)| {
            index.records.add(record);
            index.note(view, &mut row);
            (view, row)
        });
        let views = views.collect();
        index.views = views;
        index
    }

    /// Inserts a view that is not in the index.
    pub(crate) fn insert(&mut self, view: ViewId, mut row: IndexedView) {
        self.records.add(digest_of(view, &row));
        self.descriptors.insert((row.descriptor.digest, view));
        self.note(view, &mut row);
        self.views.insert(view, row);
    }

    /// Notes a new view under its label, identity, origin, content and kind of descriptor.
    fn note(&mut self, view: ViewId, row: &mut IndexedView) {
        match self.kinds.get(&row.descriptor_kind) {
            Some(kind) => row.descriptor_kind = Arc::clone(kind),
            None => drop(self.kinds.insert(Arc::clone(&row.descriptor_kind))),
        }
        self.identities.insert(row.identity, view);
        *self
            .tracks_of_origins
            .entry(origin_key(view, row))
            .or_default() += 1;
        if let Some(points) = &row.points {
            *self.blobs.entry(points.digest).or_default() += 1;
        }
        self.enlist(view, &row.register.standing);
    }

    /// Sets the label register of a view; a missing view is ignored.
    pub(crate) fn set(&mut self, view: ViewId, register: LwwRegister) {
        let Some(row) = self.views.get_mut(&view) else {
            return;
        };
        self.records.remove(digest_of(view, row));
        let before = std::mem::replace(&mut row.register, register);
        self.records.add(digest_of(view, row));
        let after = row.register.standing.clone();
        self.delist(view, &before.standing);
        self.enlist(view, &after);
    }

    /// Counts a view under its label status.
    fn enlist(&mut self, view: ViewId, standing: &LabelStatus) {
        self.n_forgotten += usize::from(*standing == LabelStatus::Forgotten);
        if let Some(name) = standing.category() {
            match self.categories.get_mut(name) {
                Some(views) => drop(views.insert(view)),
                None => drop(self.categories.insert(name.clone(), BTreeSet::from([view]))),
            }
        }
    }

    fn delist(&mut self, view: ViewId, standing: &LabelStatus) {
        self.n_forgotten -= usize::from(*standing == LabelStatus::Forgotten);
        if let Some(name) = standing.category()
            && let Some(views) = self.categories.get_mut(name)
        {
            views.remove(&view);
            if views.is_empty() {
                self.categories.remove(name);
            }
        }
    }

    /// Removes a view from the index and returns it.
    pub(crate) fn remove(&mut self, view: ViewId) -> Option<IndexedView> {
        let row = self.views.remove(&view)?;
        self.records.remove(digest_of(view, &row));
        self.delist(view, &row.register.standing);
        // A view stored again under another id has the identity.
        if self.identities.get(&row.identity) == Some(&view) {
            self.identities.remove(&row.identity);
        }
        self.descriptors.remove(&(row.descriptor.digest, view));
        if let Some(points) = &row.points {
            self.release_blob(points.digest);
        }
        self.release_origin(origin_key(view, &row));
        // One reference is the row's, one that of the set.
        if Arc::strong_count(&row.descriptor_kind) == 2 {
            self.kinds.remove(&row.descriptor_kind);
        }
        Some(row)
    }

    fn release_origin(&mut self, origin: (u128, u64, u64)) {
        let left = self.tracks_of_origins.get_mut(&origin).map_or(0, |n| {
            *n -= 1;
            *n
        });
        if left == 0 {
            self.tracks_of_origins.remove(&origin);
        }
    }

    fn release_blob(&mut self, digest: Digest) {
        let left = self.blobs.get_mut(&digest).map_or(0, |n| {
            *n -= 1;
            *n
        });
        if left == 0 {
            self.blobs.remove(&digest);
        }
    }

    /// Statistics of all categories, ordered by name.
    pub(crate) fn summaries(&self) -> Vec<CategorySummary> {
        let summary = |(name, views): (&CategoryName, &BTreeSet<ViewId>)| {
            let entries = || views.iter().filter_map(|view| self.views.get(view));
            CategorySummary {
                name: name.clone(),
                n_views: views.len() as u64,
                n_bytes: entries().map(IndexedView::n_bytes).sum(),
                last_taught_ns: entries()
                    .map(|entry| entry.register.decided.stamp_ns)
                    .max()
                    .unwrap_or(0),
            }
        };
        self.categories.iter().map(summary).collect()
    }
}

/// Queries and updates of documents.
impl StoreIndex {
    /// Present version of a document; it may record a removal.
    pub(crate) fn document(&self, key: &DocumentKey) -> Option<(u64, &DocumentVersion)> {
        let (sequence, version) = self.documents.get(key)?.last_key_value()?;
        Some((*sequence, version))
    }

    /// Decision time of the present version; 0 without one.
    pub(crate) fn document_stamp_ns(&self, key: &DocumentKey) -> u64 {
        self.document(key)
            .map_or(0, |(_, version)| version.decided.stamp_ns)
    }

    /// Sequence numbers of a document's versions, oldest first.
    pub(crate) fn versions_of(&self, key: &DocumentKey) -> impl ExactSizeIterator<Item = u64> {
        let versions = self.documents.get(key).map(|versions| versions.keys());
        versions.unwrap_or_default().copied()
    }

    /// All documents that are present.
    pub(crate) fn documents(&self) -> impl Iterator<Item = DocumentSummary> {
        self.documents
            .keys()
            .filter_map(|key| self.document_summary(key))
    }

    /// Present version of a document; `None` if it was removed.
    pub(crate) fn document_summary(&self, key: &DocumentKey) -> Option<DocumentSummary> {
        let (sequence, version) = self.document(key)?;
        Some(DocumentSummary {
            key: key.clone(),
            content: version.content.clone()?,
            decided: version.decided.clone(),
            sequence,
        })
    }

    /// Versions of a document, oldest first.
    pub(crate) fn document_revisions(
        &self,
        key: &DocumentKey,
    ) -> impl Iterator<Item = DocumentRevision> {
        let versions = self.documents.get(key).into_iter().flatten();
        versions.map(|(sequence, version)| DocumentRevision {
            sequence: *sequence,
            content: version.content.clone(),
            decided: version.decided.clone(),
        })
    }

    /// All versions with the time of their replacement; `None` for the present one.
    pub(crate) fn versions(
        &self,
    ) -> impl Iterator<Item = (&DocumentKey, u64, &DocumentVersion, Option<u64>)> {
        self.documents.iter().flat_map(|(key, versions)| {
            let later = versions.values().skip(1);
            let replaced = later.map(|version| Some(version.decided.stamp_ns));
            let replaced = replaced.chain(std::iter::once(None));
            let all = versions.iter().zip(replaced);
            all.map(move |((sequence, version), replaced_ns)| {
                (key, *sequence, version, replaced_ns)
            })
        })
    }

    pub(crate) fn insert_version(
        &mut self,
        key: &DocumentKey,
        sequence: u64,
        version: DocumentVersion,
    ) {
        if let Some(content) = &version.content {
            *self.blobs.entry(content.digest).or_default() += 1;
        }
        self.records.add(version_digest(key, sequence, &version));
        let versions = self.documents.entry(key.clone()).or_default();
        versions.insert(sequence, version);
    }

    /// Removes a document version and returns it.
    pub(crate) fn remove_version(
        &mut self,
        key: &DocumentKey,
        sequence: u64,
    ) -> Option<DocumentVersion> {
        let versions = self.documents.get_mut(key)?;
        let version = versions.remove(&sequence)?;
        if versions.is_empty() {
            self.documents.remove(key);
        }
        self.records.remove(version_digest(key, sequence, &version));
        if let Some(content) = &version.content {
            self.release_blob(content.digest);
        }
        Some(version)
    }
}

/// Queries and updates of tombstones.
impl StoreIndex {
    /// Time at which a purged view was forgotten, nanoseconds since 1970, UTC.
    pub(crate) fn tombstone(&self, identity: Digest) -> Option<u64> {
        self.tombstones.get(&identity).copied()
    }

    /// All tombstones, in the order of the identities.
    pub(crate) fn tombstones(&self) -> impl Iterator<Item = (Digest, u64)> {
        self.tombstones
            .iter()
            .map(|(identity, ns)| (*identity, *ns))
    }

    pub(crate) fn n_tombstones(&self) -> usize {
        self.tombstones.len()
    }

    pub(crate) fn bury(&mut self, identity: Digest, forgotten_ns: u64) {
        self.unbury(identity);
        self.records.add(tombstone::digest(identity, forgotten_ns));
        self.tombstones.insert(identity, forgotten_ns);
    }

    /// Removes a tombstone; a missing one is ignored.
    pub(crate) fn unbury(&mut self, identity: Digest) {
        if let Some(forgotten_ns) = self.tombstones.remove(&identity) {
            self.records
                .remove(tombstone::digest(identity, forgotten_ns));
        }
    }
}

impl StoreIndex {
    /// Digest of all records of views, documents and tombstones.
    pub(crate) fn records_digest(&self) -> Digest {
        self.records.value()
    }
}

/// First of all view ids.
const FIRST_VIEW: ViewId = ViewId {
    track_id: 0,
    view_id: 0,
};

fn origin_key(view: ViewId, row: &IndexedView) -> (u128, u64, u64) {
    (
        row.origin.memory_id,
        row.origin.view.track_id,
        view.track_id,
    )
}

fn digest_of(view: ViewId, row: &IndexedView) -> Digest {
    record_digest(&keys::view_key(keys::ROW, view), &row.seal(view))
}

fn version_digest(key: &DocumentKey, sequence: u64, version: &DocumentVersion) -> Digest {
    let key = keys::document_key(key, sequence);
    record_digest(&key, &seal(&key, version))
}
