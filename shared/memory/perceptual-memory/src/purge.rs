//! Purge: permanent deletion of content that was forgotten or replaced before a time.

use crate::decision::Decision;
use crate::index_row::IndexedView;
use crate::label_status::LabelStatus;
use crate::model::{Effect, Operation};
use crate::store_index::StoreIndex;

/// Purges content that was forgotten or replaced before `before_ns`. A forgotten view leaves a
/// tombstone that blocks its import, unless it only exceeded a retention limit.
pub(crate) fn decide(index: &StoreIndex, before_ns: u64) -> Decision {
    let is_due = |entry: &IndexedView| {
        let register = &entry.register;
        register.standing == LabelStatus::Forgotten && register.decided.stamp_ns < before_ns
    };
    let mut effects = Vec::new();
    for (view, entry) in index.all().filter(|(_, entry)| is_due(entry)) {
        effects.push(Effect::Purged { view });
        if !entry.register.decided.is_limit_decision() {
            effects.push(Effect::Tombstone {
                identity: entry.identity,
                decided: Some(entry.register.decided.clone()),
            });
        }
    }
    for (document, sequence, _, replaced_ns) in index.versions() {
        if replaced_ns.is_some_and(|replaced_ns| replaced_ns < before_ns) {
            effects.push(Effect::VersionPurged {
                document: document.clone(),
                sequence,
            });
        }
    }
    Decision::new(Operation::Purge, effects)
}
