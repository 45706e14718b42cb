//! State in which a history entry leaves a change: done, or undone.
//!
//! An undo names the entry that it undoes, which may be an undo itself. Followed to its end, each
//! entry is about one change.

use std::collections::HashMap;

use crate::error::{Error, StoreRefusal};
use crate::history::HistoryEntry;
use crate::model::Operation;
use crate::perceptual_memory::PerceptualMemory;

/// Change that an entry makes, undoes or redoes, and its state after the entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ChangeState {
    /// Sequence number of the first entry of the change.
    pub(crate) change: u64,
    /// `false` if the entry undoes the change.
    pub(crate) is_done: bool,
}

/// Change states of entries, each followed once.
#[derive(Default)]
pub(crate) struct ChangeStates {
    /// States after undo entries, by their sequence numbers.
    known: HashMap<u64, ChangeState>,
}

impl ChangeStates {
    /// Change state after an entry. An undo of an entry that is lost counts as one of a change.
    pub(crate) fn after(
        &mut self,
        entry: &HistoryEntry,
        memory: &mut PerceptualMemory,
    ) -> Result<ChangeState, Error> {
        let mut undos = Vec::new();
        let mut sequence = entry.sequence;
        let mut operation = entry.operation.clone();
        let mut state = loop {
            if let Some(known) = self.known.get(&sequence) {
                break *known;
            }
            let undone = match operation {
                // Only a forged history names a later entry.
                Operation::Undo {
                    sequence: undone, ..
                } if undone < sequence => undone,
                operation => break made_by(sequence, &operation),
            };
            undos.push(sequence);
            sequence = undone;
            operation = match memory.entry(undone) {
                Ok(entry) => entry.operation,
                Err(Error::Refused(StoreRefusal::UnknownEntry { .. })) => {
                    break made_by(undone, &Operation::StoreViews);
                }
                Err(error) => return Err(error),
            };
        };
        while let Some(undo) = undos.pop() {
            state.is_done = !state.is_done;
            self.known.insert(undo, state);
        }
        Ok(state)
    }
}

/// State after an entry that is no undo; the entries of an import are one change.
fn made_by(sequence: u64, operation: &Operation) -> ChangeState {
    let first = match operation {
        Operation::Import { part, .. } => part.first,
        _ => None,
    };
    ChangeState {
        change: first.unwrap_or(sequence),
        is_done: true,
    }
}
