//! Obstacles to further views of an object.

/// Obstacle to further views of an object, which a person can remove.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Obstacle {
    /// No scene has come for some seconds.
    NoScenes,
    /// Somebody has the object in the hand.
    InHand,
    /// The object reaches beyond the image.
    CutByImage,
    /// The object has not been seen for some seconds.
    NotSeen,
}

impl Obstacle {
    /// Sentence about a track, for a person.
    pub(crate) fn in_words(self, track: u64) -> String {
        match self {
            Self::NoScenes => "no new frames come from the camera; see `tabula status`".to_owned(),
            Self::InHand => format!("object {track} is in a hand; put it down"),
            Self::CutByImage => format!(
                "object {track} reaches beyond the image; turn the camera to it, or move it back"
            ),
            Self::NotSeen => format!("object {track} is not seen"),
        }
    }
}
