//! Taking an entry of the history back, by an entry that does the contrary.
//!
//! It is granted only while nothing that the entry touched was touched since: then
//! the store is as it was before, and nobody else's work is lost.

use std::collections::BTreeSet;

use learning::ViewId;

use crate::catalogue::Catalogue;
use crate::decision::Decision;
use crate::error::Refusal;
use crate::history::{Effect, HistoryEntry, Operation};
use crate::standing::Standing;

/// Whether people mean such an entry when they want their last lesson back.
pub(crate) fn is_lesson(operation: &Operation) -> bool {
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

/// The contrary of an entry, or why it cannot be.
pub(crate) fn decide(catalogue: &Catalogue, entry: &HistoryEntry) -> Result<Decision, Refusal> {
    let sequence = entry.sequence;
    if entry.effects.is_empty() {
        return Err(Refusal::NothingToUndo);
    }
    let stored: BTreeSet<ViewId> = entry.effects.iter().filter_map(stored_view).collect();
    let mut effects = Vec::new();
    for effect in entry.effects.iter().rev() {
        match effect {
            Effect::Stored { view, .. } => {
                let standing = present(catalogue, *view, sequence)?;
                effects.push(changed(*view, standing, Standing::Forgotten));
            }
            // It is forgotten as a whole.
            Effect::Changed { view, .. } if stored.contains(view) => {}
            Effect::Changed { view, before, .. } => {
                let standing = present(catalogue, *view, sequence)?;
                effects.push(changed(*view, standing, before.clone()));
            }
            Effect::Document {
                document, before, ..
            } => {
                let now = catalogue.document(document);
                let Some((_, version)) = now.filter(|(last, _)| *last == sequence) else {
                    return Err(Refusal::DocumentChangedSince {
                        sequence,
                        document: document.clone(),
                    });
                };
                if before
                    .as_ref()
                    .is_some_and(|b| !catalogue.has_blob(b.digest))
                {
                    return Err(Refusal::GoneForGood { sequence });
                }
                effects.push(Effect::Document {
                    document: document.clone(),
                    before: version.content.clone(),
                    after: before.clone(),
                    decided: None,
                });
            }
            // Only keeps imports from bringing something back.
            Effect::Tombstone { .. } => {}
            Effect::Purged { .. } | Effect::VersionPurged { .. } => {
                return Err(Refusal::GoneForGood { sequence });
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

/// What a view stands for by this entry, if it is the last that touched it.
fn present(catalogue: &Catalogue, view: ViewId, sequence: u64) -> Result<Standing, Refusal> {
    let Some(entry) = catalogue.get(view) else {
        return Err(Refusal::GoneForGood { sequence });
    };
    let register = &entry.register;
    if register.sequence != sequence {
        return Err(Refusal::ViewChangedSince {
            sequence,
            view,
            by: register.sequence,
        });
    }
    Ok(register.standing.clone())
}

fn changed(view: ViewId, before: Standing, after: Standing) -> Effect {
    Effect::Changed {
        view,
        before,
        after,
        decided: None,
    }
}
