//! Making an entry's effects, in the index and on disk: the same for a change just
//! asked for, for a history made again, and for a store rebuilt.

use std::sync::Arc;

use learning::ViewId;
use serde_bytes::Bytes;

use crate::catalogue::Catalogue;
use crate::decision::Contents;
use crate::digest::Digest;
use crate::document::{DocumentContent, DocumentKey, DocumentVersion};
use crate::facts::ViewParts;
use crate::history::{Effect, HistoryEntry};
use crate::keys;
use crate::meta::Meta;
use crate::standing::{Decided, Register, Standing};
use crate::writes::Writes;

/// What an entry is made in.
pub(crate) struct Target<'a> {
    pub(crate) catalogue: &'a mut Catalogue,
    pub(crate) meta: &'a mut Meta,
    pub(crate) writes: &'a mut Writes,
}

impl Target<'_> {
    /// Makes the entry with its effects; `contents` has what comes in new. A view
    /// whose content is not there is left out: it was purged since.
    pub(crate) fn apply(&mut self, entry: &HistoryEntry, contents: &Contents) {
        let (record, digest) = entry.seal();
        let key = keys::history_key(entry.sequence);
        self.writes.put_sealed(&key, &record);
        self.meta.sequence = entry.sequence;
        self.meta.head = digest;
        if let Some(id) = entry.mutation {
            self.catalogue.answered.insert(id, entry.sequence);
        }
        for effect in &entry.effects {
            self.make(entry, effect, contents);
        }
    }

    fn make(&mut self, entry: &HistoryEntry, effect: &Effect, contents: &Contents) {
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
        let facts = &parts.facts;
        if !self.catalogue.has_descriptor(facts.descriptor.digest) {
            let key = keys::digest_key(keys::DESCRIPTOR, facts.descriptor.digest);
            self.writes.put(&key, &Bytes::new(&parts.descriptor));
        }
        if let (Some(extent), Some(points)) = (facts.points, &parts.points) {
            self.put_blob(extent.digest, points);
        }
        self.writes.put(&keys::view_key(keys::VIEW, view), facts);
        let register = Register::untouched(sequence);
        self.catalogue.insert(view, facts, register);
        self.meta.n_views += 1;
    }

    fn put_blob(&mut self, digest: Digest, content: &[u8]) {
        if !self.catalogue.has_blob(digest) {
            let key = keys::digest_key(keys::BLOB, digest);
            self.writes.put(&key, &Bytes::new(content));
        }
    }

    fn change(
        &mut self,
        entry: &HistoryEntry,
        view: ViewId,
        after: &Standing,
        decided: Option<&Decided>,
    ) {
        let Some(known) = self.catalogue.get(view) else {
            return;
        };
        let register = Register {
            standing: after.clone(),
            decided: decided
                .cloned()
                .unwrap_or_else(|| later(entry, known.register.decided.stamp_ns)),
            sequence: entry.sequence,
        };
        self.writes
            .put(&keys::view_key(keys::REGISTER, view), &register);
        self.catalogue.set(view, register);
    }

    fn purge(&mut self, view: ViewId) {
        let Some(gone) = self.catalogue.remove(view) else {
            return;
        };
        self.meta.n_views -= 1;
        self.writes.delete(&keys::view_key(keys::VIEW, view));
        self.writes.delete(&keys::view_key(keys::REGISTER, view));
        let digest = gone.descriptor.digest;
        if !self.catalogue.has_descriptor(digest) {
            self.writes
                .delete(&keys::digest_key(keys::DESCRIPTOR, digest));
        }
        if let Some(points) = gone.points {
            self.release_blob(points.digest);
        }
    }

    fn release_blob(&mut self, digest: Digest) {
        if !self.catalogue.has_blob(digest) {
            self.writes.delete(&keys::digest_key(keys::BLOB, digest));
        }
    }

    fn bury(&mut self, identity: Digest, decided: Option<&Decided>) {
        let key = keys::digest_key(keys::TOMBSTONE, identity);
        if let Some(decided) = decided {
            self.writes.put(&key, decided);
            self.catalogue.tombstones.insert(identity, decided.clone());
        } else {
            self.writes.delete(&key);
            self.catalogue.tombstones.remove(&identity);
        }
    }

    fn put_document(
        &mut self,
        entry: &HistoryEntry,
        document: &DocumentKey,
        after: Option<&DocumentContent>,
        decided: Option<&Decided>,
        contents: &Contents,
    ) {
        if let Some(content) = after
            && !self.catalogue.has_blob(content.digest)
        {
            let Some(bytes) = contents.documents.get(&content.digest) else {
                return;
            };
            self.put_blob(content.digest, bytes);
        }
        let last_stamp_ns = self.catalogue.document_stamp_ns(document);
        let version = DocumentVersion {
            content: after.cloned(),
            decided: decided
                .cloned()
                .unwrap_or_else(|| later(entry, last_stamp_ns)),
        };
        let key = keys::document_key(document, entry.sequence);
        self.writes.put(&key, &version);
        self.catalogue
            .insert_version(document, entry.sequence, version);
    }

    fn purge_version(&mut self, document: &DocumentKey, sequence: u64) {
        let Some(gone) = self.catalogue.remove_version(document, sequence) else {
            return;
        };
        self.writes.delete(&keys::document_key(document, sequence));
        if let Some(content) = gone.content {
            self.release_blob(content.digest);
        }
    }
}

/// Decided by who asked for the entry.
fn later(entry: &HistoryEntry, last_stamp_ns: u64) -> Decided {
    Decided::after(last_stamp_ns, Arc::clone(&entry.author), entry.wall_ns)
}
