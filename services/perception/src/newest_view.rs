//! Newest view of each track: its times, and its use as a key view.

use message::ActorStamps;
use std::collections::BTreeMap;

/// Newest views by track-id.
pub(crate) type NewestViews = BTreeMap<u64, NewestView>;

/// Newest view of a track, for the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NewestView {
    /// True if the view is a key view of the latest frame.
    pub(crate) is_key_view: bool,
    /// Times at which the view passed through the object's actor.
    pub(crate) stamps: ActorStamps,
}
