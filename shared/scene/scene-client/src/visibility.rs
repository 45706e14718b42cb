//! Visibility of a tracked object in the frame of its scene.

use message::{SceneObject, TrackState};

/// `true` for an object that is measured in the frame of its scene.
pub fn is_seen(object: &SceneObject) -> bool {
    TrackState::from_code(object.state) == Some(TrackState::Tracked)
}

/// `true` for an object that is measured, and that the image does not cut.
pub fn is_seen_whole(object: &SceneObject) -> bool {
    is_seen(object) && object.cut_by_image == 0
}
