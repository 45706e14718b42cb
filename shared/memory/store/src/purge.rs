//! Removing content for good: what was forgotten or replaced long enough ago that
//! nobody will take it back.

use crate::catalogue::{Catalogue, Entry};
use crate::decision::Decision;
use crate::economy;
use crate::history::{Effect, Operation};
use crate::standing::Standing;

/// Purges what was forgotten or replaced before `before_ns`. A forgotten view
/// leaves a tombstone, so that no import brings it back, unless it only exceeded a
/// limit.
pub(crate) fn decide(catalogue: &Catalogue, before_ns: u64) -> Decision {
    let is_due = |entry: &Entry| {
        let register = &entry.register;
        register.standing == Standing::Forgotten && register.decided.stamp_ns < before_ns
    };
    let mut effects = Vec::new();
    for (view, entry) in catalogue.all().filter(|(_, entry)| is_due(entry)) {
        effects.push(Effect::Purged { view });
        if !economy::is_own_limit(&entry.register.decided) {
            effects.push(Effect::Tombstone {
                identity: entry.identity,
                decided: Some(entry.register.decided.clone()),
            });
        }
    }
    for (document, sequence, _, replaced_ns) in catalogue.versions() {
        if replaced_ns.is_some_and(|replaced_ns| replaced_ns < before_ns) {
            effects.push(Effect::VersionPurged {
                document: document.clone(),
                sequence,
            });
        }
    }
    Decision::new(Operation::Purge, effects)
}
