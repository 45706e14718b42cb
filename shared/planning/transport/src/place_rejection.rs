//! Reasons why an object cannot be set down at a place, as sentences.

use crate::arm_collision::ArmObstacle;
use grasping::{GraspScene, Obstacle};

/// Reason why an object cannot be set down at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaceRejection {
    /// No support surface is seen there, or the object would stand over the rim of it.
    NoSurface,
    /// The object would stand over the outline of the place.
    OverOutline,
    /// The place is not seen, so that nobody knows what stands there.
    Unseen,
    /// The camera would not see all of the object there, and nobody could verify that it stands.
    CutByImage,
    /// Something stands there, or too near.
    Occupied {
        /// Thing that stands there.
        by: Obstacle,
    },
    /// The hand would hit something as it sets the object down or leaves it.
    HandHits {
        /// Thing that would be hit.
        what: Obstacle,
    },
    /// The arm cannot move along the way down or back.
    OutOfReach,
    /// The arm would hit something on the way down or back.
    ArmHits(ArmObstacle),
}

impl PlaceRejection {
    /// True where the object does not fit into the outline.
    pub(crate) fn is_over_outline(&self) -> bool {
        matches!(self, Self::OverOutline)
    }

    /// True where other things are in the way.
    pub(crate) fn is_occupied(&self) -> bool {
        matches!(self, Self::Occupied { .. } | Self::HandHits { .. })
    }

    /// Reason in words, with the names of the things of a scene.
    pub fn words(&self, scene: &GraspScene<'_>) -> String {
        match self {
            Self::NoSurface => "no surface is seen below all of it".to_owned(),
            Self::OverOutline => "it is larger than the place".to_owned(),
            Self::Unseen => "the place is not seen".to_owned(),
            Self::CutByImage => "the camera would not see it whole there".to_owned(),
            Self::Occupied { by } => format!("{} is there", by.name(scene)),
            Self::HandHits { what } => format!("the hand would hit {}", what.name(scene)),
            Self::OutOfReach => "out of the arm's reach".to_owned(),
            Self::ArmHits(hit) => format!("the arm would hit {}", hit.name(scene)),
        }
    }
}
