//! Identifier of a key view: track-id and view number.

use serde::{Deserialize, Serialize};

/// Identifier of one view of one track; never reused. Ordered by track, then view.
/// Serialised as the pair of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "(u64, u32)", from = "(u64, u32)")]
pub struct ViewId {
    /// Track-id of the object that the view shows.
    pub track_id: u64,
    /// View number within the track.
    pub view_id: u32,
}

impl From<ViewId> for (u64, u32) {
    fn from(id: ViewId) -> Self {
        (id.track_id, id.view_id)
    }
}

impl From<(u64, u32)> for ViewId {
    fn from((track_id, view_id): (u64, u32)) -> Self {
        Self { track_id, view_id }
    }
}
