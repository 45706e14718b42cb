//! Exchange types: views and documents with their provenance, independent of local ids.

use std::collections::{BTreeMap, BTreeSet};

use learning::{CategoryName, ViewId};

use crate::digest::Digest;
use crate::document::MemoryDocument;
use crate::document_key::DocumentKey;
use crate::error::StoreRefusal;
use crate::label_status::{DecisionStamp, LabelStatus};
use crate::view::{CapturedView, MAX_NAME_BYTES, Origin};
use crate::view_record::ViewParts;

/// View exported by another memory.
#[derive(Debug, Clone, PartialEq)]
pub enum ForeignView {
    /// Foreign view with its content.
    Present {
        /// Foreign view; its id has no meaning in this memory.
        view: Box<CapturedView>,
        /// Provenance: memory and id under which the view was first stored.
        origin: Origin,
        /// Label status of the foreign view.
        standing: LabelStatus,
        /// Author and time of the label status; `None` for a view that was never labelled.
        decided: Option<DecisionStamp>,
    },
    /// Foreign view that was forgotten, without content.
    Forgotten {
        /// Content digest of the view.
        identity: Digest,
        /// Author and time of the forgetting of the view.
        decided: DecisionStamp,
    },
}

impl ForeignView {
    /// Content digest of the view, independent of its local id.
    pub fn identity(&self) -> Digest {
        match self {
            Self::Present { view, origin, .. } => ViewParts::of(view, *origin).metadata.identity(),
            Self::Forgotten { identity, .. } => *identity,
        }
    }

    /// Label status of the foreign view.
    pub fn standing(&self) -> &LabelStatus {
        match self {
            Self::Present { standing, .. } => standing,
            Self::Forgotten { .. } => &LabelStatus::Forgotten,
        }
    }

    /// Kind of the descriptor; `None` for a forgotten view.
    pub fn descriptor_kind(&self) -> Option<&str> {
        match self {
            Self::Present { view, .. } => Some(&view.descriptor.kind),
            Self::Forgotten { .. } => None,
        }
    }

    /// Author and time of the label status; `None` for a view that was never labelled.
    pub fn decided(&self) -> Option<&DecisionStamp> {
        match self {
            Self::Present { decided, .. } => decided.as_ref(),
            Self::Forgotten { decided, .. } => Some(decided),
        }
    }

    /// Gives the decision, if there is one, another time.
    pub fn restamp(&mut self, stamp_ns: u64) {
        let decided = match self {
            Self::Present { decided, .. } => decided.as_mut(),
            Self::Forgotten { decided, .. } => Some(decided),
        };
        if let Some(decided) = decided {
            decided.stamp_ns = stamp_ns;
        }
    }

    /// Renames the category of a labelled view.
    pub fn rename(&mut self, name: impl FnOnce(&CategoryName) -> Option<CategoryName>) {
        if let Self::Present { standing, .. } = self
            && let Some(other) = standing.category().and_then(name)
        {
            *standing = LabelStatus::Named(other);
        }
    }

    pub(crate) fn n_large_bytes(&self) -> usize {
        match self {
            Self::Present { view, .. } => view.n_large_bytes(),
            Self::Forgotten { .. } => 0,
        }
    }

    /// Refuses invalid values and decisions in the future.
    pub(crate) fn check(&self, wall_ns: u64) -> Result<(), StoreRefusal> {
        match self {
            Self::Present { view, decided, .. } => {
                view.check()?;
                decided
                    .as_ref()
                    .map_or(Ok(()), |decided| check_decided(decided, wall_ns))
            }
            Self::Forgotten { decided, .. } => check_decided(decided, wall_ns),
        }
    }
}

/// Document exported by another memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ForeignDocument {
    /// Key of the document.
    pub key: DocumentKey,
    /// Content of the document; `None` if it was removed.
    pub document: Option<MemoryDocument>,
    /// Author and time of the document's last change.
    pub decided: DecisionStamp,
}

impl ForeignDocument {
    pub(crate) fn n_bytes(&self) -> usize {
        self.document
            .as_ref()
            .map_or(0, |document| document.content.len())
    }

    /// Refuses invalid values and decisions in the future.
    pub(crate) fn check(&self, wall_ns: u64) -> Result<(), StoreRefusal> {
        self.key.check()?;
        check_decided(&self.decided, wall_ns)?;
        self.document.as_ref().map_or(Ok(()), MemoryDocument::check)
    }
}

/// Refuses a decision in the future, which would win over every local one.
fn check_decided(decided: &DecisionStamp, wall_ns: u64) -> Result<(), StoreRefusal> {
    if decided.is_too_far_ahead(wall_ns) {
        let ahead_h = (decided.stamp_ns - wall_ns) / 3_600_000_000_000;
        return Err(StoreRefusal::DecidedInTheFuture { ahead_h });
    }
    if decided.author.len() > MAX_NAME_BYTES {
        return Err(StoreRefusal::AuthorTooLong {
            n_bytes: decided.author.len(),
            most: MAX_NAME_BYTES,
        });
    }
    Ok(())
}

/// Allocator of local ids for foreign views: the views of one foreign track share one local track.
pub(crate) struct ForeignIdAllocator {
    next_track_id: u64,
    /// Local track-id and next view id, by memory and track-id of the origin.
    tracks: BTreeMap<(u128, u64), (u64, u32)>,
    given: BTreeSet<ViewId>,
}

impl ForeignIdAllocator {
    pub(crate) fn new(next_track_id: u64) -> Self {
        Self {
            next_track_id,
            tracks: BTreeMap::new(),
            given: BTreeSet::new(),
        }
    }

    /// First track-id that no foreign track got.
    pub(crate) fn next_track_id(&self) -> u64 {
        self.next_track_id
    }

    /// Reserves an id; `false` if it is taken.
    pub(crate) fn give(&mut self, view: ViewId) -> bool {
        self.given.insert(view)
    }

    /// Local id for a view from `origin`. `known` gives the existing local track and its next view
    /// id; it is called once per track.
    pub(crate) fn id_for(
        &mut self,
        origin: Origin,
        known: impl FnOnce() -> Option<(u64, u32)>,
    ) -> ViewId {
        let next_track_id = &mut self.next_track_id;
        let mut begin_track = || {
            *next_track_id += 1;
            (*next_track_id - 1, 0)
        };
        let (track_id, next_view) = self
            .tracks
            .entry((origin.memory_id, origin.view.track_id))
            .or_insert_with(|| known().unwrap_or_else(&mut begin_track));
        loop {
            let view = ViewId {
                track_id: *track_id,
                view_id: *next_view,
            };
            if let Some(next) = next_view.checked_add(1) {
                *next_view = next;
            } else {
                (*track_id, *next_view) = begin_track();
            }
            if self.given.insert(view) {
                return view;
            }
        }
    }
}
