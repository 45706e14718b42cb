//! Result of one labelled scene: scores, timings and picture.

use constraint::Assumptions;
use evaluation::hypothesis_image::HypothesisImages;
use evaluation::segmentation_score::{Overlaps, SegmentationScore, score};
use serde::Serialize;
use statistics::percentiles::Percentiles;

/// Detection result of one scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneResult {
    pub(super) name: String,
    pub(super) group: String,
    #[serde(skip)]
    pub(super) is_odd: bool,
    #[serde(skip)]
    pub(super) has_up: bool,
    #[serde(skip)]
    pub(super) assumptions: Assumptions,
    pub(super) n_points: usize,
    /// Scores of the parts apart, against the labels as they are.
    #[serde(flatten)]
    pub(super) scores: PsiScores,
    /// Scores of whole objects, against labels whose parts are joined.
    pub(super) whole_objects: PsiScores,
    /// Scores over draws that must not matter; `None` without draws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) draws: Option<SceneDraws>,
    /// Percentiles of the detection times, milliseconds.
    pub(super) detection_ms: Percentiles,
    /// Detection times, milliseconds, one for each repetition.
    #[serde(skip)]
    pub(super) durations_ms: Vec<f64>,
    /// Times of reading the cloud's bytes once, milliseconds: the memory bandwidth floor.
    #[serde(skip)]
    pub(super) pass_ms: Vec<f64>,
    /// Path of the picture, relative to the output folder.
    pub(super) picture: String,
}

/// weighted overlap of a scene over draws that must not matter.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct SceneDraws {
    /// With depth noise drawn anew.
    pub(super) noise: WovRange,
    /// With the image shifted against the subsampling.
    pub(super) shifted: WovRange,
}

/// Range of weighted overlap, from 0 to 1.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct WovRange {
    min: f64,
    max: f64,
}

impl WovRange {
    /// Range of at least one value.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        Some(Self {
            min: values.iter().copied().min_by(f64::total_cmp)?,
            max: values.iter().copied().max_by(f64::total_cmp)?,
        })
    }

    pub(super) fn spread(&self) -> f64 {
        self.max - self.min
    }
}

/// Scores of the hypotheses before and after the candidate rule ψ.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct PsiScores {
    #[serde(flatten)]
    pub(super) before_psi: SegmentationScore,
    pub(super) after_psi: SegmentationScore,
}

impl PsiScores {
    /// Scores of the hypotheses of a scene; `None` without a labelled object.
    pub(super) fn of(found: &HypothesisImages, labels: &[u16]) -> Option<Self> {
        let score_of = |hypotheses: &[u16]| score(&Overlaps::count(hypotheses, labels));
        Some(Self {
            before_psi: score_of(&found.before_psi)?,
            after_psi: score_of(&found.after_psi)?,
        })
    }

    /// Mean of the scores of scenes; `None` without scenes.
    pub(super) fn mean<'a>(scores: impl Iterator<Item = &'a Self> + Clone) -> Option<Self> {
        Some(Self {
            before_psi: SegmentationScore::mean(scores.clone().map(|one| &one.before_psi))?,
            after_psi: SegmentationScore::mean(scores.map(|one| &one.after_psi))?,
        })
    }
}

/// Skipped scene with its reason.
#[derive(Debug, Serialize)]
pub(super) struct SkippedScene {
    pub(super) name: String,
    pub(super) reason: String,
}
