//! Reasons why a grasp is rejected, as sentences.

use crate::grasp_scene::GraspScene;
use crate::obstacles::Obstacle;
use arm_kinematics::Error;

/// Part of a grasp in which something would be hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum GraspPhase {
    /// Straight way to the object.
    Approach,
    /// Closing of the fingers.
    Closing,
    /// Way up with the object.
    Lift,
}

/// Reason why a grasp is rejected.
#[derive(Debug, Clone, PartialEq)]
pub enum Rejection {
    /// The object is wider than the hand opens there.
    TooWide {
        /// Distance of the contacts, metres.
        width_m: f64,
        /// Greatest opening less the clearance, metres.
        limit_m: f64,
    },
    /// The fingers or the palm would hit the object itself.
    HitsObject,
    /// A pad would touch too little of the object.
    LittleContact,
    /// The surfaces under the pads are too slanted for the friction.
    Slips,
    /// The estimated weight needs more than the fingers hold by friction.
    TooHeavy {
        /// Estimated mass, kilograms.
        mass_kg: f64,
    },
    /// Something is in the way.
    Hits {
        /// Thing that would be hit.
        what: Obstacle,
        /// Part of the grasp.
        phase: GraspPhase,
    },
    /// Something lies on the object.
    Covered {
        /// Thing that lies on it.
        by: Obstacle,
    },
    /// Too much of the way leads through space that nobody has seen.
    Unseen {
        /// Share of the hand's way, 0 to 1.
        share: f64,
    },
    /// The arm cannot move along the way.
    OutOfReach(Error),
    /// The score is too low: its factors are all weak.
    Weak {
        /// Score, 0 to 1.
        score: f64,
    },
    /// The arm would hit itself on the way.
    HitsItself,
}

impl Rejection {
    /// Stage of the planning in which the grasp was rejected: 2 after the hand fitted the object, 1 for
    /// one that is too wide, 0 for a place at which no hand would close.
    pub(crate) fn stage(&self) -> u8 {
        match self {
            Self::HitsObject | Self::LittleContact | Self::Slips => 0,
            Self::TooWide { .. } => 1,
            Self::TooHeavy { .. }
            | Self::Hits { .. }
            | Self::Covered { .. }
            | Self::Unseen { .. }
            | Self::OutOfReach(_)
            | Self::Weak { .. }
            | Self::HitsItself => 2,
        }
    }

    /// Reason in words, with the names of the things of a scene.
    pub fn words(&self, scene: &GraspScene<'_>) -> String {
        match self {
            Self::TooWide { width_m, limit_m } => {
                format!("too wide: {:.0} mm of {:.0}", 1e3 * width_m, 1e3 * limit_m)
            }
            Self::HitsObject => "fingers or palm would hit the object itself".to_owned(),
            Self::LittleContact => "too little of a pad would touch it".to_owned(),
            Self::Slips => "it would slip from between the pads".to_owned(),
            Self::TooHeavy { mass_kg } => format!("too heavy: about {mass_kg:.1} kg"),
            Self::Hits { what, phase } => {
                let name = what.name(scene);
                match phase {
                    GraspPhase::Approach => format!("would hit {name}"),
                    GraspPhase::Closing => format!("would hit {name} as the fingers close"),
                    GraspPhase::Lift => format!("would hit {name} on the way up"),
                }
            }
            Self::Covered { by } => format!("{} lies on it", by.name(scene)),
            Self::Unseen { share } => {
                format!("{:.0} % of the hand's way is not seen", 100.0 * share)
            }
            Self::OutOfReach(_) => "out of the arm's reach".to_owned(),
            Self::Weak { score } => format!("too weak: score {score:.3}"),
            Self::HitsItself => "the arm would hit itself".to_owned(),
        }
    }
}
