//! Scripted actions of the simulated person.

use crate::model_choice::ModelChoice;

/// Scripted action. Objects are identified by their number in the scene, from 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Brings an object and puts it down.
    Put {
        /// Model of the object that is brought.
        model: ModelChoice,
        /// Target position, world x and y, metres.
        to_m: [f64; 2],
    },
    /// Carries an object to another place on the table.
    Move {
        /// Number of the object to move.
        object: u16,
        /// Target position, world x and y, metres.
        to_m: [f64; 2],
    },
    /// Pushes an object over the table without lifting it; it pushes the objects it meets.
    Slide {
        /// Number of the object to push.
        object: u16,
        /// Target position, world x and y, metres.
        to_m: [f64; 2],
    },
    /// Lifts an object, holds it for a while and puts it back.
    Lift {
        /// Number of the object to lift.
        object: u16,
        /// Time for which the object is held, seconds.
        for_s: f64,
    },
    /// Lifts an object, turns it about the vertical and puts it back.
    Turn {
        /// Number of the object to turn.
        object: u16,
        /// Angle of the turn, radians, counter-clockwise as seen from above.
        by_rad: f64,
    },
    /// Holds the hand in front of an object, so that it is partly occluded.
    Hide {
        /// Number of the object to hide.
        object: u16,
        /// Time for which the object stays hidden, seconds.
        for_s: f64,
    },
    /// Takes an object off the table.
    Remove {
        /// Number of the object to take away.
        object: u16,
    },
}

impl Action {
    /// Number of the affected object; `None` for [`Self::Put`].
    pub(crate) fn object(&self) -> Option<usize> {
        match self {
            Self::Put { .. } => None,
            Self::Move { object, .. }
            | Self::Slide { object, .. }
            | Self::Lift { object, .. }
            | Self::Turn { object, .. }
            | Self::Hide { object, .. }
            | Self::Remove { object } => Some(usize::from(*object)),
        }
    }

    /// Description of the action for messages: `move object 3`.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::Put { model, .. } => format!("put a {}", model.category()),
            Self::Move { object, .. } => format!("move object {object}"),
            Self::Slide { object, .. } => format!("slide object {object}"),
            Self::Lift { object, .. } => format!("lift object {object}"),
            Self::Turn { object, .. } => format!("turn object {object}"),
            Self::Hide { object, .. } => format!("hide object {object}"),
            Self::Remove { object } => format!("remove object {object}"),
        }
    }
}

/// Action with its start time. It starts later when the previous one has not ended.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedAction {
    /// Start time, seconds from the start of the scene.
    pub at_s: f64,
    /// Scripted action to perform.
    pub action: Action,
}

/// Behaviour of the simulated person: script and random actions.
#[derive(Debug, Clone, PartialEq)]
pub struct PersonPlan {
    /// Scripted actions in the order of their start times.
    pub script: Vec<TimedAction>,
    /// Speed factor of the hand; 1 is the default speed.
    pub pace: f64,
    /// Shortest and longest pause between random actions, seconds; `None` for the script only.
    pub random_pause_s: Option<[f64; 2]>,
}

impl Default for PersonPlan {
    /// Person who stands still and does nothing.
    fn default() -> Self {
        Self {
            script: Vec::new(),
            pace: 1.0,
            random_pause_s: None,
        }
    }
}
