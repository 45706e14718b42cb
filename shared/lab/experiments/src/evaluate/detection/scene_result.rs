//! Result of one labelled scene: scores, timings and picture.

use constraint::Assumptions;
use evaluation::segmentation_score::SegmentationScore;
use serde::Serialize;

/// What came out of one scene.
pub(super) struct SceneResult {
    pub(super) name: String,
    pub(super) group: String,
    pub(super) is_odd: bool,
    pub(super) has_up: bool,
    pub(super) assumptions: Assumptions,
    pub(super) n_points: usize,
    pub(super) before_psi: SegmentationScore,
    pub(super) after_psi: SegmentationScore,
    /// Of each repeat, milliseconds.
    pub(super) detection_ms: Vec<f64>,
    /// Of reading the cloud's bytes once, milliseconds.
    pub(super) pass_ms: Vec<f64>,
    /// Relative to the folder of the results.
    pub(super) picture: String,
}

/// A scene that was left out.
#[derive(Debug, Serialize)]
pub(super) struct SkippedScene {
    pub(super) name: String,
    pub(super) reason: String,
}
