//! Tracked sequence and scored tracking run.

use evaluation::tracked_frame::TrackedFrame;
use evaluation::tracking_score::TrackingScore;
use std::collections::BTreeMap;

/// What became of a scenario.
pub(super) struct TrackedSequence {
    pub(super) frames: Vec<TrackedFrame>,
    /// Names of the objects by number.
    pub(super) names: BTreeMap<u64, String>,
    /// What happened in it that somebody should know.
    pub(super) notes: Vec<String>,
}

/// What came out of one run.
pub(super) struct TrackingRun {
    pub(super) scene: String,
    /// `None` of a recording.
    pub(super) seed: Option<u64>,
    pub(super) n_frames: usize,
    pub(super) score: TrackingScore,
    pub(super) notes: Vec<String>,
    /// Relative to the folder of the results.
    pub(super) picture: String,
}
