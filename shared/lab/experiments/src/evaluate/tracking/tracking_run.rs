//! Tracked sequence and the tracking run scored from it.

use evaluation::tracked_frame::TrackedFrame;
use evaluation::tracking_score::TrackingScore;
use std::collections::BTreeMap;

/// Tracked frames of one sequence.
pub(super) struct TrackedSequence {
    pub(super) frames: Vec<TrackedFrame>,
    /// Names of the objects by number.
    pub(super) names: BTreeMap<u64, String>,
    /// Notes of the simulation, one sentence each.
    pub(super) notes: Vec<String>,
}

/// Tracking run with its scores.
pub(super) struct TrackingRun {
    pub(super) scene: String,
    /// Random seed of the run; `None` for a recording.
    pub(super) seed: Option<u64>,
    pub(super) n_frames: usize,
    pub(super) score: TrackingScore,
    pub(super) notes: Vec<String>,
    /// Path of the figure, relative to the output folder.
    pub(super) picture: String,
}
