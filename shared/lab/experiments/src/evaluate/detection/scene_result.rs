//! Result of one labelled scene: scores, timings and picture.

use constraint::Assumptions;
use evaluation::segmentation_score::SegmentationScore;
use serde::Serialize;

/// Detection result of one scene.
pub(super) struct SceneResult {
    pub(super) name: String,
    pub(super) group: String,
    pub(super) is_odd: bool,
    pub(super) has_up: bool,
    pub(super) assumptions: Assumptions,
    pub(super) n_points: usize,
    pub(super) before_psi: SegmentationScore,
    pub(super) after_psi: SegmentationScore,
    /// Detection times, milliseconds, one for each repetition.
    pub(super) detection_ms: Vec<f64>,
    /// Times of reading the cloud's bytes once, milliseconds: the memory bandwidth floor.
    pub(super) pass_ms: Vec<f64>,
    /// Path of the picture, relative to the output folder.
    pub(super) picture: String,
}

/// Skipped scene with its reason.
#[derive(Debug, Serialize)]
pub(super) struct SkippedScene {
    pub(super) name: String,
    pub(super) reason: String,
}
