//! Obstacles of an undo or redo: later changes of the same views and documents.
//!
//! The changes of an item are a stack, since a change is undone only while it is on top. A later
//! change is no obstacle once it is undone, nor is an undo that was redone.

use std::collections::HashMap;

use crate::change_state::ChangeState;
use crate::changed_item::{ChangedItem, items};
use crate::history::HistoryEntry;
use crate::store_index::StoreIndex;

/// Stacks of the items of one change, in comparison with the moment after that change was made,
/// undone or redone.
pub(crate) struct TouchStacks {
    change: u64,
    stacks: HashMap<ChangedItem, TouchStack>,
}

/// Changes of an item that are not taken back, each with the entry that made or undid it.
struct TouchStack {
    /// Later changes that are in effect.
    above: Vec<(u64, u64)>,
    /// Earlier changes that were undone since.
    missing: Vec<(u64, u64)>,
    /// Last entry that changed the item.
    last: u64,
}

impl TouchStacks {
    /// Stacks after the entries of a change, in their order.
    pub(crate) fn after(change: u64, entries: &[HistoryEntry]) -> Self {
        let mut stacks = HashMap::new();
        for entry in entries {
            for item in items(entry) {
                stacks.entry(item).or_insert(TouchStack {
                    above: Vec::new(),
                    missing: Vec::new(),
                    last: entry.sequence,
                });
            }
        }
        Self { change, stacks }
    }

    /// `true` if an entry changes one of the items.
    pub(crate) fn is_touched_by(&self, entry: &HistoryEntry) -> bool {
        items(entry).any(|item| self.stacks.contains_key(&item))
    }

    /// Adds a later entry, with the change that it is about.
    pub(crate) fn add(&mut self, entry: &HistoryEntry, state: ChangeState) {
        for item in items(entry) {
            let Some(stack) = self.stacks.get_mut(&item) else {
                continue;
            };
            // An item may be touched twice by an entry, or lie behind it in a long import.
            if entry.sequence <= stack.last {
                continue;
            }
            stack.last = entry.sequence;
            if state.change != self.change {
                stack.touch(state, entry.sequence);
            }
        }
    }

    /// First item of the entries that was changed later, and the entry that changed it.
    pub(crate) fn obstacle(
        &self,
        entries: &[HistoryEntry],
        index: &StoreIndex,
    ) -> Option<(ChangedItem, u64)> {
        entries.iter().flat_map(items).find_map(|item| {
            let stack = self.stacks.get(&item)?;
            let top = stack.above.last().or(stack.missing.last());
            // A lost entry is known by its number only.
            let known = item.last_changed(index)?;
            let by = top.map(|(_, by)| *by);
            let by = by.or_else(|| (known != stack.last).then_some(known))?;
            Some((item, by))
        })
    }
}

impl TouchStack {
    fn touch(&mut self, state: ChangeState, by: u64) {
        let is_top = |stack: &[(u64, u64)]| stack.last().is_some_and(|top| top.0 == state.change);
        let touch = (state.change, by);
        match state.is_done {
            true if is_top(&self.missing) => drop(self.missing.pop()),
            true if is_top(&self.above) => {}
            true => self.above.push(touch),
            false if is_top(&self.above) => drop(self.above.pop()),
            false => self.missing.push(touch),
        }
    }
}
