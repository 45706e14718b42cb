//! The history: every change ever made, numbered without a gap from one.

use std::collections::BTreeSet;

use learning::CategoryName;
use serde::{Deserialize, Serialize};

use crate::mutation::MutationId;
use crate::view::ViewKey;

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
    /// The views it changed, with their names before and after.
    pub views: Vec<ViewChange>,
}

/// A view's name before and after a change; both are absent when the view was stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewChange {
    /// Which view.
    pub view: ViewKey,
    /// The name it had.
    pub before: Option<CategoryName>,
    /// The name it has got.
    pub after: Option<CategoryName>,
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
    names: Vec<String>,
    /// Track, view, name before, name after.
    views: Vec<(u64, u32, Option<u32>, Option<u32>)>,
}

impl PackedEntry {
    pub(crate) fn of(entry: &HistoryEntry) -> Self {
        let changes = entry.views.iter();
        let names: BTreeSet<&str> = changes
            .flat_map(|change| [&change.before, &change.after])
            .filter_map(|name| name.as_ref().map(CategoryName::as_str))
            .collect();
        let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
        let index = |name: &Option<CategoryName>| {
            let name = name.as_ref()?.as_str();
            names.binary_search_by(|known| known.as_str().cmp(name)).ok().map(|i| i as u32)
        };
        let views = entry
            .views
            .iter()
            .map(|change| {
                let ViewKey { track_id, view_id } = change.view;
                (track_id, view_id, index(&change.before), index(&change.after))
            })
            .collect();
        Self {
            wall_ns: entry.wall_ns,
            author: entry.author.clone(),
            operation: entry.operation,
            mutation: entry.mutation.map(|id| id.0.to_be_bytes()),
            names,
            views,
        }
    }

    /// The entry, unless a name in it is none.
    pub(crate) fn unpack(self, sequence: u64) -> Option<HistoryEntry> {
        let names: Vec<CategoryName> =
            self.names.iter().map(|name| CategoryName::new(name).ok()).collect::<Option<_>>()?;
        let name = |index: Option<u32>| match index {
            Some(index) => names.get(index as usize).cloned().map(Some),
            None => Some(None),
        };
        let views = self
            .views
            .iter()
            .map(|&(track_id, view_id, before, after)| {
                let view = ViewKey { track_id, view_id };
                Some(ViewChange { view, before: name(before)?, after: name(after)? })
            })
            .collect::<Option<_>>()?;
        Some(HistoryEntry {
            sequence,
            wall_ns: self.wall_ns,
            author: self.author,
            operation: self.operation,
            mutation: self.mutation.map(|id| MutationId(u128::from_be_bytes(id))),
            views,
        })
    }
}
