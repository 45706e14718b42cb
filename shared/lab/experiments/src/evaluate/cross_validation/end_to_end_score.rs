//! End-to-end score of detection and recognition in scenes.

use super::fold_result::FoldResult;
use crate::evaluate::scene_views::SceneStatistics;
use evaluation::cross_validation::ConfusionMatrix;
use serde::Serialize;

/// Precision, recall and F1 of detection followed by recognition, over all scenes.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct EndToEndScore {
    n_scenes: usize,
    /// Number of objects that show a pixel with depth.
    n_objects: u32,
    /// Number of objects without a pixel with depth; not scored.
    n_hidden: u32,
    n_found: u32,
    n_missed: u32,
    /// Number of false candidates: no object, or a smaller part of one.
    n_false_candidates: usize,
    /// Number of false candidates that are parts of an object.
    n_parts: u32,
    /// Number of false candidates that were given a name.
    n_false_names: usize,
    /// Precision: right names over all given names, including those of false candidates.
    precision: f64,
    /// Recall: right names over all objects, including missed ones.
    recall: f64,
    /// F1 score: harmonic mean of precision and recall.
    f1: f64,
}

impl EndToEndScore {
    pub(super) fn of(
        scenes: &SceneStatistics,
        results: &[FoldResult],
        confusion: &ConfusionMatrix,
    ) -> Self {
        let n_categories = confusion.n_categories();
        let rows = || (0..n_categories).map(|truth| confusion.row(truth));
        let n_found: u32 = rows().flatten().sum();
        let n_named: u32 = rows().flat_map(|row| &row[..n_categories]).sum();
        let n_right: u32 = rows().enumerate().map(|(truth, row)| row[truth]).sum();
        let n_objects: u32 = scenes.n_visible.iter().sum();
        let clutter = || results.iter().flat_map(|result| &result.clutter);
        let n_false_names = clutter().filter(|answer| answer.category.is_some()).count();
        let n_given = f64::from(n_named) + n_false_names as f64;
        let n_right = f64::from(n_right);
        Self {
            n_scenes: scenes.n_scenes,
            n_objects,
            n_hidden: scenes.n_hidden,
            n_found,
            n_missed: n_objects.saturating_sub(n_found),
            n_false_candidates: clutter().count(),
            n_parts: scenes.n_parts.iter().sum(),
            n_false_names,
            precision: n_right / n_given.max(1.0),
            recall: n_right / f64::from(n_objects.max(1)),
            f1: 2.0 * n_right / (n_given + f64::from(n_objects)).max(1.0),
        }
    }

    /// Sentences about the score for the report page.
    pub(super) fn sentences(&self) -> [String; 2] {
        [
            format!(
                "{} scenes with {} objects that are seen: {} found, {} missed; {} false \
                 candidates, {} of them parts of objects",
                self.n_scenes,
                self.n_objects,
                self.n_found,
                self.n_missed,
                self.n_false_candidates,
                self.n_parts
            ),
            format!(
                "detection and recognition together: precision {:.4}, recall {:.4}, F1 {:.4}",
                self.precision, self.recall, self.f1
            ),
        ]
    }
}
