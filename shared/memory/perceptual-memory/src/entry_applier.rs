//! Application of a history entry to index and database; shared by new mutations, replay and
//! rebuild.

use std::sync::Arc;

use learning::ViewId;
use serde_bytes::Bytes;

use crate::decision::NewContent;
use crate::digest::Digest;
use crate::document::{DocumentContent, DocumentVersion};
use crate::document_key::DocumentKey;
use crate::history::HistoryEntry;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::meta::Meta;
use crate::model::Effect;
use crate::record_batch::RecordBatch;
use crate::store_index::StoreIndex;
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
                    self.store(*view, parts, entry.sequence);
                }
            }
            Effect::Changed {
                view,
                after,
                decided,
                ..
            } => self.change(entry, *view, after, decided.as_ref()),
            Effect::Purged { view } => self.purge(*view),
            Effect::Tombstone { identity, decided } => self.bury(*identity, decided.as_ref()),
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

    fn store(&mut self, view: ViewId, parts: &ViewParts, sequence: u64) {
        let metadata = &parts.metadata;
        if !self.index.has_descriptor(metadata.descriptor.digest) {
            let key = keys::digest_key(keys::DESCRIPTOR, metadata.descriptor.digest);
            self.writes.put(&key, &Bytes::new(&parts.descriptor));
        }
        if let (Some(extent), Some(points)) = (metadata.points, &parts.points) {
            self.put_blob(extent.digest, points);
        }
        self.writes.put(&keys::view_key(keys::VIEW, view), metadata);
        let register = LwwRegister::untouched(sequence);
        self.index.insert(view, metadata, register);
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
                .unwrap_or_else(|| later(entry, known.register.decided.stamp_ns)),
            sequence: entry.sequence,
        };
        self.writes
            .put(&keys::view_key(keys::REGISTER, view), &register);
        self.index.set(view, register);
    }

    fn purge(&mut self, view: ViewId) {
        let Some(gone) = self.index.remove(view) else {
            return;
        };
        self.meta.n_views -= 1;
        self.writes.delete(&keys::view_key(keys::VIEW, view));
        self.writes.delete(&keys::view_key(keys::REGISTER, view));
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

    fn bury(&mut self, identity: Digest, decided: Option<&DecisionStamp>) {
        let key = keys::digest_key(keys::TOMBSTONE, identity);
        if let Some(decided) = decided {
            self.writes.put(&key, decided);
            self.index.tombstones.insert(identity, decided.clone());
        } else {
            self.writes.delete(&key);
            self.index.tombstones.remove(&identity);
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
        if let Some(content) = after
            && !self.index.has_blob(content.digest)
        {
            let Some(bytes) = contents.documents.get(&content.digest) else {
                return;
            };
            self.put_blob(content.digest, bytes);
        }
        let last_stamp_ns = self.index.document_stamp_ns(document);
        let version = DocumentVersion {
            content: after.cloned(),
            decided: decided
                .cloned()
                .unwrap_or_else(|| later(entry, last_stamp_ns)),
        };
        let key = keys::document_key(document, entry.sequence);
        self.writes.put(&key, &version);
        self.index.insert_version(document, entry.sequence, version);
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

/// Decision stamp by the entry's author, later than all stamps of the store so far.
fn later(entry: &HistoryEntry, last_stamp_ns: u64) -> DecisionStamp {
    DecisionStamp::after(last_stamp_ns, Arc::clone(&entry.author), entry.wall_ns)
}
