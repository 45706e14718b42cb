//! The history: every change ever made, numbered without a gap from one.

use std::collections::BTreeSet;

use learning::{CategoryName, ViewChange, ViewId};
use serde::{Deserialize, Serialize};

use crate::mutation::MutationId;

/// What an entry of the history records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Operation {
    /// Views were stored.
    StoreViews,
    /// A track was given a name.
    Teach,
    /// A track was given another name.
    Correct,
    /// A name was taken from all views that carried it.
    Forget,
    /// The store was rebuilt from what a damaged one still held.
    Rebuild,
}

/// One change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryEntry {
    /// Its number, from one.
    pub sequence: u64,
    /// When it was asked for, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// Who asked.
    pub author: String,
    /// What was done.
    pub operation: Operation,
    /// The mutation that asked; none for what the store does by itself.
    pub mutation: Option<MutationId>,
    /// The views it stored, none of which has a name yet.
    pub stored: Vec<ViewId>,
    /// The names it changed.
    pub changes: Vec<ViewChange>,
}

/// An entry as it is stored. Names are listed once and referred to by index: a
/// track has hundreds of views and at most two names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct PackedEntry {
    wall_ns: u64,
    author: String,
    operation: Operation,
    #[serde(with = "serde_bytes")]
    mutation: Option<[u8; 16]>,
    /// Track and view.
    stored: Vec<(u64, u32)>,
    names: Vec<String>,
    /// Track, view, name before, name after.
    changes: Vec<(u64, u32, Option<u32>, Option<u32>)>,
}

impl PackedEntry {
    pub(crate) fn of(entry: &HistoryEntry) -> Self {
        let names = entry
            .changes
            .iter()
            .flat_map(|change| [&change.before, &change.after]);
        let names: BTreeSet<&str> = names.flatten().map(CategoryName::as_str).collect();
        let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
        let index = |name: &Option<CategoryName>| {
            let name = name.as_ref()?.as_str();
            names
                .binary_search_by(|known| known.as_str().cmp(name))
                .ok()
                .map(|i| i as u32)
        };
        let change = |change: &ViewChange| {
            let ViewId { track_id, view_id } = change.id;
            (
                track_id,
                view_id,
                index(&change.before),
                index(&change.after),
            )
        };
        Self {
            wall_ns: entry.wall_ns,
            author: entry.author.clone(),
            operation: entry.operation,
            mutation: entry.mutation.map(|id| id.0.to_be_bytes()),
            stored: entry
                .stored
                .iter()
                .map(|view| (view.track_id, view.view_id))
                .collect(),
            changes: entry.changes.iter().map(change).collect(),
            names,
        }
    }

    /// The entry, unless a name in it is none.
    pub(crate) fn unpack(self, sequence: u64) -> Option<HistoryEntry> {
        let names = self.names.iter().map(|name| CategoryName::new(name).ok());
        let names: Vec<CategoryName> = names.collect::<Option<_>>()?;
        let name = |index: Option<u32>| match index {
            Some(index) => names.get(index as usize).cloned().map(Some),
            None => Some(None),
        };
        let changes = self
            .changes
            .into_iter()
            .map(|(track_id, view_id, before, after)| {
                let id = ViewId { track_id, view_id };
                Some(ViewChange {
                    id,
                    before: name(before)?,
                    after: name(after)?,
                })
            });
        let stored = self.stored.into_iter();
        Some(HistoryEntry {
            sequence,
            wall_ns: self.wall_ns,
            author: self.author,
            operation: self.operation,
            mutation: self.mutation.map(|id| MutationId(u128::from_be_bytes(id))),
            stored: stored
                .map(|(track_id, view_id)| ViewId { track_id, view_id })
                .collect(),
            changes: changes.collect::<Option<_>>()?,
        })
    }
}
