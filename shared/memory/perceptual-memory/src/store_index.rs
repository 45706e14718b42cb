//! In-memory index of the store: views with their label status, answered mutations, documents.
//! Descriptors, point clouds and document content stay on disk.

use std::collections::btree_map::Entry as Slot;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Bound;
use std::sync::Arc;

use durable_leveldb::MutationId;
use learning::{CategoryName, ViewId, ViewLabel};

use crate::digest::Digest;
use crate::document::{DocumentSummary, DocumentVersion};
use crate::document_key::DocumentKey;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::model::is_among;
use crate::view::Origin;
use crate::view_record::{ContentRef, ViewMetadata};

/// View in the index with its properties.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct IndexedView {
    pub(crate) identity: Digest,
    pub(crate) descriptor: ContentRef,
    pub(crate) points: Option<ContentRef>,
    pub(crate) descriptor_kind: Arc<str>,
    pub(crate) captured_ns: u64,
    pub(crate) origin: Origin,
    pub(crate) register: LwwRegister,
}

impl IndexedView {
    pub(crate) fn n_bytes(&self) -> u64 {
        let points = self.points.map_or(0, |extent| extent.n_bytes);
        self.descriptor.n_bytes as u64 + points as u64
    }

    fn is_forgotten(&self) -> bool {
        self.register.standing == LabelStatus::Forgotten
    }
}

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
    /// Local track-ids, by memory and track-id of the origin.
    tracks_of_origins: HashMap<(u128, u64), u64>,
    /// Views by the digest of their descriptor (deduplication).
    descriptors: BTreeMap<Digest, BTreeSet<ViewId>>,
    /// Reference counts of point clouds and document content, by digest.
    blobs: HashMap<Digest, u32>,
    documents: BTreeMap<DocumentKey, BTreeMap<u64, DocumentVersion>>,
    pub(crate) tombstones: BTreeMap<Digest, DecisionStamp>,
    /// Sequence numbers of answered mutations, by idempotency key.
    pub(crate) answered: HashMap<MutationId, u64>,
    kinds: BTreeSet<Arc<str>>,
    /// First and last sequence numbers of the entries lost with a damaged store.
    pub(crate) lost: Vec<(u64, u64)>,
}

/// Queries about lost history entries.
impl StoreIndex {
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
        let origin = (origin.memory_id, origin.view.track_id);
        let track_id = *self.tracks_of_origins.get(&origin)?;
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
        let views = self.categories.get(name).into_iter().flatten();
        views.filter_map(|view| Some((*view, self.views.get(view)?)))
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
    ) -> impl Iterator<Item = (Digest, impl Iterator<Item = (ViewId, &IndexedView)>)> {
        self.descriptors.range(from..).map(|(digest, views)| {
            let views = views
                .iter()
                .filter_map(|view| Some((*view, self.views.get(view)?)));
            (*digest, views)
        })
    }

    /// `true` if a view has this descriptor.
    pub(crate) fn has_descriptor(&self, digest: Digest) -> bool {
        self.descriptors.contains_key(&digest)
    }

    /// `true` if a view or document has this content.
    pub(crate) fn has_blob(&self, digest: Digest) -> bool {
        self.blobs.contains_key(&digest)
    }

    pub(crate) fn insert(&mut self, view: ViewId, facts: &ViewMetadata, register: LwwRegister) {
        let identity = facts.identity();
        let origin = facts.origin();
        let kind: Arc<str> = match self.kinds.get(facts.descriptor_kind.as_str()) {
            Some(kind) => Arc::clone(kind),
            None => facts.descriptor_kind.as_str().into(),
        };
        self.kinds.insert(Arc::clone(&kind));
        self.identities.insert(identity, view);
        self.tracks_of_origins
            .entry((origin.memory_id, origin.view.track_id))
            .or_insert(view.track_id);
        let descriptor = facts.descriptor;
        self.descriptors
            .entry(descriptor.digest)
            .or_default()
            .insert(view);
        if let Some(points) = &facts.points {
            *self.blobs.entry(points.digest).or_default() += 1;
        }
        let entry = IndexedView {
            identity,
            descriptor,
            points: facts.points,
            descriptor_kind: kind,
            captured_ns: facts.captured_ns,
            origin,
            register: LwwRegister::untouched(register.sequence),
        };
        self.views.insert(view, entry);
        self.set(view, register);
    }

    /// Sets the label register of a view; a missing view is ignored.
    pub(crate) fn set(&mut self, view: ViewId, register: LwwRegister) {
        let Some(entry) = self.views.get_mut(&view) else {
            return;
        };
        let before = std::mem::replace(&mut entry.register, register);
        self.n_forgotten += usize::from(entry.is_forgotten());
        self.n_forgotten -= usize::from(before.standing == LabelStatus::Forgotten);
        if let Some(name) = before.standing.category()
            && let Some(views) = self.categories.get_mut(name)
        {
            views.remove(&view);
            if views.is_empty() {
                self.categories.remove(name);
            }
        }
        if let Some(name) = entry.register.standing.category() {
            let name = name.clone();
            self.categories.entry(name).or_default().insert(view);
        }
    }

    /// Removes a view from the index and returns it.
    pub(crate) fn remove(&mut self, view: ViewId) -> Option<IndexedView> {
        self.set(view, LwwRegister::untouched(0));
        let entry = self.views.remove(&view)?;
        self.identities.remove(&entry.identity);
        if let Slot::Occupied(mut views) = self.descriptors.entry(entry.descriptor.digest) {
            views.get_mut().remove(&view);
            if views.get().is_empty() {
                views.remove();
            }
        }
        if let Some(points) = &entry.points {
            self.release_blob(points.digest);
        }
        Some(entry)
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

    /// All documents that are present.
    pub(crate) fn documents(&self) -> impl Iterator<Item = DocumentSummary> {
        self.documents.iter().filter_map(|(key, versions)| {
            let (sequence, version) = versions.last_key_value()?;
            Some(DocumentSummary {
                key: key.clone(),
                content: version.content.clone()?,
                decided: version.decided.clone(),
                sequence: *sequence,
            })
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
        if let Some(content) = &version.content {
            self.release_blob(content.digest);
        }
        Some(version)
    }
}
