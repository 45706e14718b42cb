//! Undo of a change by a compensating history entry.
//!
//! The state before is restored exactly. [`crate::undo_list`] finds the change, and refuses it if
//! anything of it was changed later, so that no later work is lost.

use std::collections::BTreeSet;
use std::fmt;

use learning::ViewId;

use crate::changed_item::items;
use crate::decision::Decision;
use crate::error::StoreRefusal;
use crate::history::HistoryEntry;
use crate::label_status::LabelStatus;
use crate::model::{Effect, Operation};
use crate::store_index::StoreIndex;

/// Direction of a request: undo or redo. `Display` gives the participle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reversal {
    /// Undo of a change.
    Undo,
    /// Redo of an undone change.
    Redo,
}

impl fmt::Display for Reversal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Undo => "undone",
            Self::Redo => "redone",
        })
    }
}

/// `true` for an entry in the undo list of its user: it changed something, and a user asked for
/// it.
pub(crate) fn is_change(entry: &HistoryEntry) -> bool {
    let is_asked_for = matches!(
        entry.operation,
        Operation::Teach { .. }
            | Operation::Correct { .. }
            | Operation::Forget { .. }
            | Operation::Rename { .. }
            | Operation::MergeCategories { .. }
            | Operation::NormaliseNames { .. }
            | Operation::Import { .. }
            | Operation::PutDocument { .. }
            | Operation::RemoveDocument { .. }
    );
    is_asked_for && is_reversible(entry)
}

/// `true` for an entry that changed a view or a document. A tombstone alone only blocks imports.
pub(crate) fn is_reversible(entry: &HistoryEntry) -> bool {
    items(entry).next().is_some()
}

/// Change that is undone or redone: the number by which sentences name it, and the entries whose
/// effects are taken back.
pub(crate) struct Reversed<'a> {
    pub(crate) sequence: u64,
    pub(crate) reversal: Reversal,
    pub(crate) entries: &'a [HistoryEntry],
}

impl Reversed<'_> {
    /// Refusal because content of the change was purged.
    fn gone(&self) -> StoreRefusal {
        StoreRefusal::GoneForGood {
            sequence: self.sequence,
            reversal: self.reversal,
        }
    }

    /// Compensating decision, or the reason for a refusal. Nothing of the change was changed since.
    pub(crate) fn decide(
        &self,
        index: &StoreIndex,
        operation: Operation,
    ) -> Result<Decision, StoreRefusal> {
        let all = || self.entries.iter().flat_map(|entry| &entry.effects);
        let stored: BTreeSet<ViewId> = all().filter_map(stored_view).collect();
        let mut effects = Vec::new();
        for entry in self.entries.iter().rev() {
            for effect in entry.effects.iter().rev() {
                match effect {
                    Effect::Stored { view, .. } => {
                        effects.push(self.label(index, *view, LabelStatus::Forgotten)?);
                    }
                    // The view is forgotten as a whole.
                    Effect::Changed { view, .. } if stored.contains(view) => {}
                    Effect::Changed { view, before, .. } => {
                        effects.push(self.label(index, *view, before.clone())?);
                    }
                    Effect::Document { .. } => effects.push(self.document(index, effect)?),
                    // A tombstone only blocks imports.
                    Effect::Tombstone { .. } => {}
                    // An old version that a new one displaced stays away.
                    Effect::VersionPurged { .. }
                        if matches!(entry.operation, Operation::PutDocument { .. }) => {}
                    Effect::Purged { .. } | Effect::VersionPurged { .. } => {
                        return Err(self.gone());
                    }
                }
            }
        }
        Ok(Decision::new(operation, effects))
    }

    /// Change of a view to the label status before.
    fn label(
        &self,
        index: &StoreIndex,
        view: ViewId,
        after: LabelStatus,
    ) -> Result<Effect, StoreRefusal> {
        let row = index.get(view).ok_or_else(|| self.gone())?;
        Ok(Effect::Changed {
            view,
            before: row.register.standing.clone(),
            after,
            decided: None,
        })
    }

    /// Replacement of a document by its version before.
    fn document(&self, index: &StoreIndex, effect: &Effect) -> Result<Effect, StoreRefusal> {
        let Effect::Document {
            document, before, ..
        } = effect
        else {
            return Err(self.gone());
        };
        let (_, now) = index.document(document).ok_or_else(|| self.gone())?;
        if before.as_ref().is_some_and(|b| !index.has_blob(b.digest)) {
            return Err(self.gone());
        }
        Ok(Effect::Document {
            document: document.clone(),
            before: now.content.clone(),
            after: before.clone(),
            decided: None,
        })
    }
}

fn stored_view(effect: &Effect) -> Option<ViewId> {
    match effect {
        Effect::Stored { view, .. } => Some(*view),
        _ => None,
    }
}
