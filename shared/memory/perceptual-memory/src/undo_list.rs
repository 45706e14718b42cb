//! Undo list and redo list of a user, read from the history.
//!
//! Undo walks back through the changes of its user that are in effect, redo through those that the
//! user undid since the last change. Both follow from the entries alone, so that they are the same
//! after a restart.

use std::collections::HashSet;

use crate::change_state::ChangeStates;
use crate::changed_item::{ChangedItem, items};
use crate::decision::Decision;
use crate::entry_reader::EntryReader;
use crate::error::{Error, StoreRefusal};
use crate::history::HistoryEntry;
use crate::model::Operation;
use crate::mutation::Mutation;
use crate::perceptual_memory::PerceptualMemory;
use crate::touch_stack::TouchStacks;
use crate::undo::{Reversal, Reversed, is_change, is_reversible};

/// Number of newest history entries among which the lists are looked for. Chosen: all that the
/// database keeps by default.
const LOOKS_BACK: u64 = 16_384;

/// Change of the lists, with the last entry that made, undid or redid it.
struct ListedChange {
    change: u64,
    last: HistoryEntry,
}

impl PerceptualMemory {
    /// Decides the undo of an entry, or of the last change of the requester that is in effect.
    pub(crate) fn decide_undo(
        &mut self,
        sequence: Option<u64>,
        request: &Mutation,
    ) -> Result<Decision, Error> {
        let Some(sequence) = sequence else {
            let listed = self.last_done(request)?;
            let operation = Operation::Undo {
                sequence: listed.change,
                redone: None,
            };
            return self.reverse(&listed, listed.change, Reversal::Undo, operation);
        };
        let entry = self.entry(sequence)?;
        if !request.requester.may_undo(&entry) {
            let author = entry.author;
            return Err(StoreRefusal::OthersEntry { sequence, author }.into());
        }
        if !is_reversible(&entry) {
            return Err(StoreRefusal::NothingToUndo.into());
        }
        let mut states = ChangeStates::default();
        let state = states.after(&entry, self)?;
        let last = self.last_about(state.change, entry, &mut states)?;
        if states.after(&last, self)?.is_done != state.is_done {
            let by = last.sequence;
            return Err(StoreRefusal::UndoneAlready { sequence, by }.into());
        }
        let operation = Operation::Undo {
            sequence,
            redone: (!state.is_done).then_some(state.change),
        };
        let change = state.change;
        let listed = ListedChange { change, last };
        self.reverse(&listed, sequence, Reversal::Undo, operation)
    }

    /// Decides the redo of the change that the requester undid last.
    pub(crate) fn decide_redo(&mut self, request: &Mutation) -> Result<Decision, Error> {
        let listed = self.last_undone(request)?;
        let operation = Operation::Undo {
            sequence: listed.last.sequence,
            redone: Some(listed.change),
        };
        self.reverse(&listed, listed.change, Reversal::Redo, operation)
    }

    /// Last change that the requester made or redid, and that is in effect.
    fn last_done(&mut self, request: &Mutation) -> Result<ListedChange, Error> {
        let mut states = ChangeStates::default();
        let mut met = HashSet::new();
        let mut reader = self.read_back();
        while let Some(entry) = reader.next(self)? {
            let is_undo = matches!(entry.operation, Operation::Undo { .. });
            if !is_undo && !is_change(&entry) {
                continue;
            }
            let state = states.after(&entry, self)?;
            // The newest entry about a change gives its state.
            if !met.insert(state.change) || !state.is_done {
                continue;
            }
            if is_own(&entry, request) || self.is_own_change(state.change, request)? {
                let change = state.change;
                return Ok(ListedChange {
                    change,
                    last: entry,
                });
            }
        }
        Err(StoreRefusal::NothingToUndo.into())
    }

    /// Change that the requester undid last, after the last change that the requester made.
    fn last_undone(&mut self, request: &Mutation) -> Result<ListedChange, Error> {
        let mut states = ChangeStates::default();
        let mut met = HashSet::new();
        let mut reader = self.read_back();
        while let Some(entry) = reader.next(self)? {
            let is_undo = matches!(entry.operation, Operation::Undo { .. });
            if !is_undo && is_change(&entry) && is_own(&entry, request) {
                break;
            }
            if !is_undo {
                continue;
            }
            let state = states.after(&entry, self)?;
            let is_newest = met.insert(state.change);
            if is_newest && !state.is_done && is_own(&entry, request) {
                let change = state.change;
                return Ok(ListedChange {
                    change,
                    last: entry,
                });
            }
        }
        Err(StoreRefusal::NothingToRedo.into())
    }

    fn read_back(&self) -> EntryReader {
        let last = self.meta.sequence;
        EntryReader::backward(last.saturating_sub(LOOKS_BACK) + 1..=last)
    }

    fn is_own_change(&mut self, change: u64, request: &Mutation) -> Result<bool, Error> {
        match self.entry(change) {
            Ok(entry) => Ok(is_change(&entry) && is_own(&entry, request)),
            Err(Error::Refused(StoreRefusal::UnknownEntry { .. })) => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Last entry that made, undid or redid a change of which one entry is given.
    fn last_about(
        &mut self,
        change: u64,
        entry: HistoryEntry,
        states: &mut ChangeStates,
    ) -> Result<HistoryEntry, Error> {
        if !is_part(&entry) && self.stands(std::slice::from_ref(&entry)) {
            return Ok(entry);
        }
        let mut reader = EntryReader::forward(entry.sequence + 1..=self.meta.sequence);
        let mut last = entry;
        while let Some(entry) = reader.next(self)? {
            if is_reversible(&entry) && states.after(&entry, self)?.change == change {
                last = entry;
            }
        }
        Ok(last)
    }

    /// `true` if nothing that the entries changed was changed after them.
    fn stands(&self, entries: &[HistoryEntry]) -> bool {
        entries.iter().all(|entry| {
            let mut last = items(entry).filter_map(|item| item.last_changed(&self.index));
            last.all(|last| last == entry.sequence)
        })
    }

    /// Compensating decision for the last entry about a change, or for all entries of an import.
    fn reverse(
        &mut self,
        listed: &ListedChange,
        sequence: u64,
        reversal: Reversal,
        operation: Operation,
    ) -> Result<Decision, Error> {
        let entries = if is_part(&listed.last) {
            self.parts_of_import(listed.change)?
        } else {
            vec![listed.last.clone()]
        };
        if !self.stands(&entries)
            && let Some((item, by)) = self.obstacle(listed.change, &entries)?
        {
            let author = self.entry(by).ok().map(|entry| entry.author);
            return Err(StoreRefusal::ChangedSince {
                sequence,
                reversal,
                item,
                by,
                author,
            }
            .into());
        }
        let entries = &entries[..];
        let reversed = Reversed {
            sequence,
            reversal,
            entries,
        };
        Ok(reversed.decide(&self.index, operation)?)
    }

    /// Entries of an import, in their order.
    fn parts_of_import(&mut self, first: u64) -> Result<Vec<HistoryEntry>, Error> {
        let mut reader = EntryReader::forward(first.max(1)..=self.meta.sequence);
        let mut parts = Vec::new();
        while let Some(entry) = reader.next(self)? {
            let Operation::Import { part, .. } = entry.operation else {
                continue;
            };
            if entry.sequence == first || part.first == Some(first) {
                parts.push(entry);
                if !part.is_continued {
                    break;
                }
            }
        }
        Ok(parts)
    }

    /// Item of a change that was changed after the given entries about it, and the entry that
    /// changed it.
    fn obstacle(
        &mut self,
        change: u64,
        entries: &[HistoryEntry],
    ) -> Result<Option<(ChangedItem, u64)>, Error> {
        let Some(first) = entries.first() else {
            return Ok(None);
        };
        let mut states = ChangeStates::default();
        let mut stacks = TouchStacks::after(change, entries);
        let mut reader = EntryReader::forward(first.sequence + 1..=self.meta.sequence);
        while let Some(entry) = reader.next(self)? {
            if stacks.is_touched_by(&entry) {
                let state = states.after(&entry, self)?;
                stacks.add(&entry, state);
            }
        }
        Ok(stacks.obstacle(entries, &self.index))
    }
}

/// `true` for an entry of the requester, which the requester may undo.
fn is_own(entry: &HistoryEntry, request: &Mutation) -> bool {
    *entry.author == request.author && request.requester.may_undo(entry)
}

/// `true` for one of several entries of an import.
fn is_part(entry: &HistoryEntry) -> bool {
    matches!(&entry.operation, Operation::Import { part, .. } if !part.is_whole())
}
