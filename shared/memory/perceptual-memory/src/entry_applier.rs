//! Application of a history entry to index and database; shared by new mutations, replay and
//! rebuild.

use learning::ViewId;
use serde_bytes::Bytes;

use crate::decision::NewContent;
use crate::digest::Digest;
use crate::document::{DocumentContent, DocumentVersion};
use crate::document_key::DocumentKey;
use crate::history::HistoryEntry;
use crate::index_row::IndexedView;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::meta::Meta;
use crate::model::Effect;
use crate::record_batch::RecordBatch;
use crate::store_index::StoreIndex;
use crate::tombstone::seal_tombstone;
use crate::view_record::ViewParts;

/// Target of the application: index, metadata and pending writes.
pub(crate) struct EntryApplier<'a> {
    pub(crate) index: &'a mut StoreIndex,
    pub(crate) meta: &'a mut Meta,
    pub(crate) writes: &'a mut RecordBatch,
}

impl EntryApplier<'_> {
    /// Applies an entry with its effects; `contents` holds inserted content. A view whose content
    /// is missing is skipped: it was purged later.
    pub(crate) fn apply(&mut self, entry: &HistoryEntry, contents: &NewContent) {
        let (record, digest) = entry.seal();
        let key = keys::history_key(entry.sequence);
        self.writes.put_sealed(&key, &record);
        self.meta.sequence = entry.sequence;
        self.meta.head = digest;
        if let Some(id) = entry.mutation {
            self.index.answered.insert(id, entry.sequence);
        }
        for effect in &entry.effects {
            self.make(entry, effect, contents);
        }
    }

    fn make(&mut self, entry: &HistoryEntry, effect: &Effect, contents: &NewContent) {
        match effect {
            Effect::Stored { view, identity } => {
                if let Some(parts) = contents.views.get(identity) {
                    self.store(*view, parts, LwwRegister::untouched(entry.sequence));
                }
            }
            Effect::Changed {
                view,
                after,
                decided,
                ..
            } => self.change(entry, *view, after, decided.as_ref()),
            Effect::Purged { view } => self.purge(*view),
            Effect::Tombstone { identity, decided } => {
                self.bury(*identity, decided.as_ref().map(|decided| decided.stamp_ns));
            }
            Effect::Document {
                document,
                after,
                decided,
                ..
            } => self.put_document(entry, document, after.as_ref(), decided.as_ref(), contents),
            Effect::VersionPurged { document, sequence } => {
                self.purge_version(document, *sequence);
            }
        }
    }

    /// Stores a view with a label register.
    pub(crate) fn store(&mut self, view: ViewId, parts: &ViewParts, register: LwwRegister) {
        let metadata = &parts.metadata;
        if !self.index.has_descriptor(metadata.descriptor.digest) {
            let key = keys::digest_key(keys::DESCRIPTOR, metadata.descriptor.digest);
            self.writes.put(&key, &Bytes::new(&parts.descriptor));
        }
        if let (Some(extent), Some(points)) = (metadata.points, &parts.points) {
            self.put_blob(extent.digest, points);
        }
        self.writes.put(&keys::view_key(keys::VIEW, view), metadata);
        let row = IndexedView::of(metadata, register);
        self.writes
            .put_sealed(&keys::view_key(keys::ROW, view), &row.seal(view));
        self.index.insert(view, row);
        self.meta.n_views += 1;
    }

    fn put_blob(&mut self, digest: Digest, content: &[u8]) {
        if !self.index.has_blob(digest) {
            let key = keys::digest_key(keys::BLOB, digest);
            self.writes.put(&key, &Bytes::new(content));
        }
    }

    fn change(
        &mut self,
        entry: &HistoryEntry,
        view: ViewId,
        after: &LabelStatus,
        decided: Option<&DecisionStamp>,
    ) {
        let Some(known) = self.index.get(view) else {
            return;
        };
        let register = LwwRegister {
            standing: after.clone(),
            decided: decided
                .cloned()
                .unwrap_or_else(|| entry.decided_after(known.register.decided.stamp_ns)),
            sequence: entry.sequence,
        };
        let row = IndexedView {
            register: register.clone(),
            ..known.clone()
        };
        self.writes
            .put_sealed(&keys::view_key(keys::ROW, view), &row.seal(view));
        self.index.set(view, register);
    }

    fn purge(&mut self, view: ViewId) {
        let Some(gone) = self.index.remove(view) else {
            return;
        };
        self.meta.n_views -= 1;
        self.writes.delete(&keys::view_key(keys::VIEW, view));
        self.writes.delete(&keys::view_key(keys::ROW, view));
        let digest = gone.descriptor.digest;
        if !self.index.has_descriptor(digest) {
            self.writes
                .delete(&keys::digest_key(keys::DESCRIPTOR, digest));
        }
        if let Some(points) = gone.points {
            self.release_blob(points.digest);
        }
    }

    fn release_blob(&mut self, digest: Digest) {
        if !self.index.has_blob(digest) {
            self.writes.delete(&keys::digest_key(keys::BLOB, digest));
        }
    }

    /// Sets the tombstone of a purged view, or clears it.
    pub(crate) fn bury(&mut self, identity: Digest, forgotten_ns: Option<u64>) {
        let key = keys::digest_key(keys::TOMBSTONE, identity);
        if let Some(forgotten_ns) = forgotten_ns {
            self.writes
                .put_sealed(&key, &seal_tombstone(identity, forgotten_ns));
            self.index.bury(identity, forgotten_ns);
        } else {
            self.writes.delete(&key);
            self.index.unbury(identity);
        }
    }

    fn put_document(
        &mut self,
        entry: &HistoryEntry,
        document: &DocumentKey,
        after: Option<&DocumentContent>,
        decided: Option<&DecisionStamp>,
        contents: &NewContent,
    ) {
        let last_stamp_ns = self.index.document_stamp_ns(document);
        let version = DocumentVersion {
            content: after.cloned(),
            decided: decided
                .cloned()
                .unwrap_or_else(|| entry.decided_after(last_stamp_ns)),
        };
        let content = after.and_then(|content| contents.documents.get(&content.digest));
        self.put_version(
            document,
            entry.sequence,
            version,
            content.map(Vec::as_slice),
        );
    }

    /// Stores a version of a document; ignored when its content is neither given nor stored.
    pub(crate) fn put_version(
        &mut self,
        document: &DocumentKey,
        sequence: u64,
        version: DocumentVersion,
        content: Option<&[u8]>,
    ) {
        if let Some(summary) = &version.content
            && !self.index.has_blob(summary.digest)
        {
            let Some(content) = content else {
                return;
            };
            self.put_blob(summary.digest, content);
        }
        self.writes
            .put(&keys::document_key(document, sequence), &version);
        self.index.insert_version(document, sequence, version);
    }

    fn purge_version(&mut self, document: &DocumentKey, sequence: u64) {
        let Some(gone) = self.index.remove_version(document, sequence) else {
            return;
        };
        self.writes.delete(&keys::document_key(document, sequence));
        if let Some(content) = gone.content {
            self.release_blob(content.digest);
        }
    }
}
