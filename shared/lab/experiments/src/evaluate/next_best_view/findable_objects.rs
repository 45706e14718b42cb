//! Findable objects: what a closed loop can be asked to find.

use super::captured_view::CapturedView;

/// Share of the views in which detection finds a findable object at least. Chosen.
const FINDABLE_SHARE: f64 = 0.05;
/// Findable objects: those that detection finds in at least one in twenty of the views. Others are
/// buried, or found by accident.
pub(super) fn findable(views: &[CapturedView]) -> Vec<bool> {
    let n_objects = views
        .first()
        .map_or(0, |view| view.segments.is_detected.len());
    let n_views = |object: usize| {
        let found = views
            .iter()
            .filter(|view| view.segments.is_detected[object]);
        found.count()
    };
    let n_min = (FINDABLE_SHARE * views.len() as f64).max(1.0);
    (0..n_objects)
        .map(|object| n_views(object) as f64 >= n_min)
        .collect()
}
