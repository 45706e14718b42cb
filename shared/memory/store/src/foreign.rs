//! What one memory tells another: views and documents with their provenance, in
//! a form that does not depend on the ids either gave them.

use std::collections::{BTreeMap, BTreeSet};

use learning::{CategoryName, ViewId};

use crate::digest::Digest;
use crate::document::{Document, DocumentKey};
use crate::error::Refusal;
use crate::facts::ViewParts;
use crate::standing::{Decided, Standing};
use crate::view::{MAX_NAME_BYTES, Origin, View};

/// How far the clocks of two robots may be apart: a day.
const MAX_AHEAD_NS: u64 = 24 * 3_600_000_000_000;

/// A view of another memory.
#[derive(Debug, Clone, PartialEq)]
pub enum ForeignView {
    /// With its content.
    Present {
        /// The view; the id in it means nothing here.
        view: Box<View>,
        /// Where it was first stored.
        origin: Origin,
        /// What it stands for.
        standing: Standing,
        /// Who decided that; nobody when it was never named.
        decided: Option<Decided>,
    },
    /// Only that it was forgotten.
    Forgotten {
        /// Digest of everything that was in it.
        identity: Digest,
        /// Who forgot it.
        decided: Decided,
    },
}

impl ForeignView {
    /// The view, apart from its id.
    pub fn identity(&self) -> Digest {
        match self {
            Self::Present { view, origin, .. } => ViewParts::of(view, *origin).facts.identity(),
            Self::Forgotten { identity, .. } => *identity,
        }
    }

    /// What it is an example of.
    pub fn standing(&self) -> &Standing {
        match self {
            Self::Present { standing, .. } => standing,
            Self::Forgotten { .. } => &Standing::Forgotten,
        }
    }

    /// How its descriptor was made; none of a forgotten one.
    pub fn descriptor_kind(&self) -> Option<&str> {
        match self {
            Self::Present { view, .. } => Some(&view.descriptor.kind),
            Self::Forgotten { .. } => None,
        }
    }

    /// Has a named view carry another name.
    pub fn rename(&mut self, name: impl FnOnce(&CategoryName) -> Option<CategoryName>) {
        if let Self::Present { standing, .. } = self
            && let Some(other) = standing.category().and_then(name)
        {
            *standing = Standing::Named(other);
        }
    }

    pub(crate) fn n_large_bytes(&self) -> usize {
        match self {
            Self::Present { view, .. } => view.n_large_bytes(),
            Self::Forgotten { .. } => 0,
        }
    }

    /// Refuses what could not be read back, and what was decided in the future.
    pub(crate) fn check(&self, wall_ns: u64) -> Result<(), Refusal> {
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

/// A document of another memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ForeignDocument {
    /// Which one.
    pub key: DocumentKey,
    /// None: it was removed.
    pub document: Option<Document>,
    /// Who decided that.
    pub decided: Decided,
}

impl ForeignDocument {
    pub(crate) fn n_bytes(&self) -> usize {
        self.document
            .as_ref()
            .map_or(0, |document| document.content.len())
    }

    /// Refuses what could not be read back, and what was decided in the future.
    pub(crate) fn check(&self, wall_ns: u64) -> Result<(), Refusal> {
        self.key.check()?;
        check_decided(&self.decided, wall_ns)?;
        self.document.as_ref().map_or(Ok(()), Document::check)
    }
}

/// A decision of the future would hold against every one made here.
fn check_decided(decided: &Decided, wall_ns: u64) -> Result<(), Refusal> {
    let ahead_ns = decided.stamp_ns.saturating_sub(wall_ns);
    if ahead_ns > MAX_AHEAD_NS {
        let ahead_h = ahead_ns / 3_600_000_000_000;
        return Err(Refusal::DecidedInTheFuture { ahead_h });
    }
    if decided.author.len() > MAX_NAME_BYTES {
        return Err(Refusal::AuthorTooLong {
            n_bytes: decided.author.len(),
            most: MAX_NAME_BYTES,
        });
    }
    Ok(())
}

/// Finds the ids under which foreign views come in: the views of one foreign track
/// are those of one track here.
pub(crate) struct Newcomers {
    next_track_id: u64,
    /// Of the tracks met so far: the track here, and the next view of it.
    tracks: BTreeMap<(u128, u64), (u64, u32)>,
    given: BTreeSet<ViewId>,
}

impl Newcomers {
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

    /// Gives the id itself, if nobody has got it.
    pub(crate) fn give(&mut self, view: ViewId) -> bool {
        self.given.insert(view)
    }

    /// The id for a view from `origin`; `known` is asked once for each track for the
    /// track here, and its next view.
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
