//! Visibility of a track and occlusion state of its expected box.

/// Occlusion state of the expected box of a track without a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OcclusionState {
    /// Occlusion not tested, or a surface is there that may be the object.
    Unknown,
    /// Free space: the visible surface lies behind the expected box, so the object is
    /// gone.
    Empty,
    /// Expected box covered by a nearer surface.
    Occluded,
    /// Expected box outside the image.
    OutOfView,
}

/// Visibility of a track's object in the last frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Object measured in the last frame.
    Visible,
    /// Object occluded by another surface.
    Occluded,
    /// Object outside the image.
    OutOfView,
    /// Object that should be visible but was not detected.
    Missing,
}
