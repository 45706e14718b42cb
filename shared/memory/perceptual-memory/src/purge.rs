//! Purge: permanent deletion of content that was forgotten or replaced before a time, and of
//! tombstones that are old enough.
//!
//! One purge deletes a limited number of items, so that no request waits long for it.

use crate::decision::Decision;
use crate::document::MAX_DOCUMENT_VERSIONS;
use crate::document_key::DocumentKey;
use crate::label_status::LabelStatus;
use crate::model::{Effect, Operation};
use crate::store_index::StoreIndex;

/// Maximum number of items that one purge deletes. Chosen: it takes some milliseconds.
const MAX_ITEMS: usize = 1000;

/// Purges content that was forgotten or replaced before `before_ns`. A forgotten view leaves a
/// tombstone that blocks its import, unless it only exceeded a retention limit.
pub(crate) fn decide(index: &StoreIndex, before_ns: u64) -> Decision {
    let due = index.all().filter(|(_, row)| {
        let register = &row.register;
        register.standing == LabelStatus::Forgotten && register.decided.stamp_ns < before_ns
    });
    let mut effects = Vec::new();
    for (view, row) in due.take(MAX_ITEMS) {
        effects.push(Effect::Purged { view });
        if !row.register.decided.is_limit_decision() {
            effects.push(Effect::Tombstone {
                identity: row.identity,
                decided: Some(row.register.decided.clone()),
            });
        }
    }
    let replaced = index
        .versions()
        .filter(|(.., replaced_ns)| replaced_ns.is_some_and(|replaced_ns| replaced_ns < before_ns));
    for (document, sequence, ..) in replaced.take(MAX_ITEMS) {
        effects.push(Effect::VersionPurged {
            document: document.clone(),
            sequence,
        });
    }
    Decision::new(Operation::Purge, effects)
}

/// Purges the versions of a document that are too many when one more is stored.
pub(crate) fn surplus_versions(
    index: &StoreIndex,
    document: &DocumentKey,
) -> impl Iterator<Item = Effect> {
    let versions = index.versions_of(document);
    let n_surplus = (versions.len() + 1).saturating_sub(MAX_DOCUMENT_VERSIONS);
    versions
        .take(n_surplus)
        .map(|sequence| Effect::VersionPurged {
            document: document.clone(),
            sequence,
        })
}

/// Purges the tombstones of views that were forgotten before `before_ns`, and the notes of
/// documents that were removed before it. An import can bring them back from then on.
pub(crate) fn decide_tombstones(index: &StoreIndex, before_ns: u64) -> Decision {
    let old = index.tombstones().filter(|(_, ns)| *ns < before_ns);
    let cleared = old.map(|(identity, _)| Effect::Tombstone {
        identity,
        decided: None,
    });
    let removed = index.versions().filter(|(_, _, version, replaced_ns)| {
        let is_removal = version.content.is_none() && replaced_ns.is_none();
        is_removal && version.decided.stamp_ns < before_ns
    });
    let removed = removed.map(|(document, sequence, ..)| Effect::VersionPurged {
        document: document.clone(),
        sequence,
    });
    let effects = cleared.chain(removed).take(MAX_ITEMS).collect();
    Decision::new(Operation::Purge, effects)
}
