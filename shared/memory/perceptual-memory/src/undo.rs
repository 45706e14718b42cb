//! Undo of a history entry by a compensating entry.
//!
//! It is granted only if nothing that the entry changed was changed later. The state before is then
//! restored exactly, and no later work is lost.

use std::collections::BTreeSet;

use learning::ViewId;

use crate::decision::Decision;
use crate::error::StoreRefusal;
use crate::history::HistoryEntry;
use crate::label_status::LabelStatus;
use crate::model::{Effect, Operation};
use crate::store_index::StoreIndex;

/// `true` for the operations that an undo without a sequence number considers.
pub(crate) fn is_teaching(operation: &Operation) -> bool {
    matches!(
        operation,
        Operation::Teach { .. }
            | Operation::Correct { .. }
            | Operation::Forget { .. }
            | Operation::Rename { .. }
            | Operation::MergeCategories { .. }
            | Operation::PutDocument { .. }
            | Operation::RemoveDocument { .. }
    )
}

/// Compensating decision for an entry, or the reason for a refusal.
pub(crate) fn decide(index: &StoreIndex, entry: &HistoryEntry) -> Result<Decision, StoreRefusal> {
    let sequence = entry.sequence;
    if entry.effects.is_empty() {
        return Err(StoreRefusal::NothingToUndo);
    }
    let stored: BTreeSet<ViewId> = entry.effects.iter().filter_map(stored_view).collect();
    let mut effects = Vec::new();
    for effect in entry.effects.iter().rev() {
        match effect {
            Effect::Stored { view, .. } => {
                let standing = present(index, *view, sequence)?;
                effects.push(changed(*view, standing, LabelStatus::Forgotten));
            }
            // The view is forgotten as a whole.
            Effect::Changed { view, .. } if stored.contains(view) => {}
            Effect::Changed { view, before, .. } => {
                let standing = present(index, *view, sequence)?;
                effects.push(changed(*view, standing, before.clone()));
            }
            Effect::Document {
                document, before, ..
            } => {
                let now = index.document(document);
                let Some((_, version)) = now.filter(|(last, _)| *last == sequence) else {
                    return Err(StoreRefusal::DocumentChangedSince {
                        sequence,
                        document: document.clone(),
                    });
                };
                if before.as_ref().is_some_and(|b| !index.has_blob(b.digest)) {
                    return Err(StoreRefusal::GoneForGood { sequence });
                }
                effects.push(Effect::Document {
                    document: document.clone(),
                    before: version.content.clone(),
                    after: before.clone(),
                    decided: None,
                });
            }
            // A tombstone only blocks imports.
            Effect::Tombstone { .. } => {}
            // An old version that a new one displaced stays away.
            Effect::VersionPurged { .. }
                if matches!(entry.operation, Operation::PutDocument { .. }) => {}
            Effect::Purged { .. } | Effect::VersionPurged { .. } => {
                return Err(StoreRefusal::GoneForGood { sequence });
            }
        }
    }
    Ok(Decision::new(Operation::Undo { sequence }, effects))
}

fn stored_view(effect: &Effect) -> Option<ViewId> {
    match effect {
        Effect::Stored { view, .. } => Some(*view),
        _ => None,
    }
}

/// Label status of a view, if the given entry was the last to touch it.
fn present(index: &StoreIndex, view: ViewId, sequence: u64) -> Result<LabelStatus, StoreRefusal> {
    let Some(entry) = index.get(view) else {
        return Err(StoreRefusal::GoneForGood { sequence });
    };
    let register = &entry.register;
    if register.sequence != sequence {
        return Err(StoreRefusal::ViewChangedSince {
            sequence,
            view,
            by: register.sequence,
        });
    }
    Ok(register.standing.clone())
}

fn changed(view: ViewId, before: LabelStatus, after: LabelStatus) -> Effect {
    Effect::Changed {
        view,
        before,
        after,
        decided: None,
    }
}
