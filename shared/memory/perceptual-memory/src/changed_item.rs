//! Changed items of a history entry: the views and documents that its effects are about.

use std::fmt;

use learning::ViewId;

use crate::document_key::DocumentKey;
use crate::history::HistoryEntry;
use crate::model::Effect;
use crate::store_index::StoreIndex;
use crate::view_phrase::view_phrase;

/// View or document that a history entry changed.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ChangedItem {
    /// View whose label status changed, or that was stored or purged.
    View(ViewId),
    /// Document that was stored or removed.
    Document(DocumentKey),
}

impl fmt::Display for ChangedItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::View(view) => f.write_str(&view_phrase(*view)),
            Self::Document(key) => key.fmt(f),
        }
    }
}

impl ChangedItem {
    /// Sequence number of the last entry that changed the item; `None` if it is not stored.
    pub(crate) fn last_changed(&self, index: &StoreIndex) -> Option<u64> {
        match self {
            Self::View(view) => index.get(*view).map(|row| row.register.sequence),
            Self::Document(key) => index.document(key).map(|(sequence, _)| sequence),
        }
    }
}

/// Items of an entry, in the order of its effects; one may occur more than once.
pub(crate) fn items(entry: &HistoryEntry) -> impl Iterator<Item = ChangedItem> {
    entry.effects.iter().filter_map(|effect| match effect {
        Effect::Document { document, .. } => Some(ChangedItem::Document(document.clone())),
        effect => effect.view().map(ChangedItem::View),
    })
}
