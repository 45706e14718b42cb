//! Phrase for a view in messages.

use learning::ViewId;

/// Phrase for a view in sentences: "view 3 of track 7".
pub(crate) fn view_phrase(view: ViewId) -> String {
    format!("view {} of track {}", view.view_id, view.track_id)
}
