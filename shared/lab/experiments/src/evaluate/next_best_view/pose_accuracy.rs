//! Accuracy of recognition and registration over the segments of all views.

use super::captured_view::CapturedView;
use crate::evaluate::tabular_report::{ReportTable, percent};
use serde::Serialize;

/// Counts of segments.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct PoseCounts {
    /// Segments of all views.
    pub(super) n_segments: usize,
    /// Those that cover an object.
    pub(super) n_objects: usize,
    /// Of these, those that are recognised.
    pub(super) n_recognised: usize,
    /// Those that are identified by recognition and registration.
    pub(super) n_identified: usize,
    /// Those with the true model at a right pose: ADD-S below 0.1 of its diameter.
    pub(super) n_true_model_right: usize,
    /// Those on which the recognised model, of several the one that contradicts least, is the
    /// right one at a right pose.
    pub(super) n_right: usize,
    /// Segments whose registered model is said to be good.
    pub(super) n_good: usize,
    /// Of these, those with the right model at a right pose.
    pub(super) n_good_right: usize,
}

impl PoseCounts {
    /// Counts over the views of a scene.
    pub(super) fn of(views: &[CapturedView]) -> Self {
        let mut counts = Self::default();
        for segment in views.iter().flat_map(|view| &view.segments.segments) {
            let count = usize::from;
            counts.n_segments += 1;
            counts.n_objects += count(segment.object.is_some());
            counts.n_recognised += count(segment.is_recognised());
            counts.n_identified += count(segment.is_identified());
            let Some(model) = &segment.registered else {
                continue;
            };
            counts.n_true_model_right += count(model.is_true_model_right == Some(true));
            counts.n_right += count(model.is_right);
            counts.n_good += count(model.is_good);
            counts.n_good_right += count(model.is_good && model.is_right);
        }
        counts
    }

    /// Sum of the counts of scenes.
    pub(super) fn sum(counts: impl Iterator<Item = Self>) -> Self {
        counts.fold(Self::default(), |a, b| Self {
            n_segments: a.n_segments + b.n_segments,
            n_objects: a.n_objects + b.n_objects,
            n_recognised: a.n_recognised + b.n_recognised,
            n_identified: a.n_identified + b.n_identified,
            n_true_model_right: a.n_true_model_right + b.n_true_model_right,
            n_right: a.n_right + b.n_right,
            n_good: a.n_good + b.n_good,
            n_good_right: a.n_good_right + b.n_good_right,
        })
    }

    /// Table of each count beside the number of which it is a part.
    pub(super) fn table(&self) -> ReportTable {
        let parts = [
            ("that cover an object", self.n_objects, self.n_segments),
            ("recognised", self.n_recognised, self.n_objects),
            (
                "identified by a model as well",
                self.n_identified,
                self.n_objects,
            ),
            (
                "true model at a right pose",
                self.n_true_model_right,
                self.n_objects,
            ),
            (
                "chosen model right, at a right pose",
                self.n_right,
                self.n_objects,
            ),
            (
                "with a good model, which is right",
                self.n_good_right,
                self.n_good,
            ),
        ];
        ReportTable::of(
            "Recognition and registration",
            parts,
            &[
                ("segments", &|(name, ..)| (*name).to_owned()),
                ("number", &|(_, n, _)| n.to_string()),
                ("of them", &|(.., of)| of.to_string()),
                ("share %", &|(_, n, of)| {
                    percent(*n as f64 / (*of).max(1) as f64)
                }),
            ],
        )
    }
}
