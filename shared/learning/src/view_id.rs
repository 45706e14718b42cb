//! Identity of a view.

/// One view of one tracked object; never used twice. Ordered by track, then view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ViewId {
    /// The track.
    pub track_id: u64,
    /// The view of the track.
    pub view_id: u32,
}
