//! A person at the far side of the table: what they do, and where their body is.
//!
//! A person puts an object down, moves it, lifts it, hides it partly, or takes
//! it away; by a script, or now and then by chance. The body is a chain of
//! capsules; only the hand moves things.

mod body;
mod choice;
mod errand;

pub(crate) use body::Body;
pub(crate) use choice::Chance;
pub(crate) use errand::{Errand, GRIP_M, HandEvent, Surroundings};

use crate::scene::ModelChoice;
use nalgebra::Point3;

impl Action {
    /// Number of the object it is done to; `None` for one that is brought.
    pub(crate) fn object(&self) -> Option<usize> {
        match self {
            Self::Put { .. } => None,
            Self::Move { object, .. }
            | Self::Slide { object, .. }
            | Self::Lift { object, .. }
            | Self::Hide { object, .. }
            | Self::Remove { object } => Some(usize::from(*object)),
        }
    }

    /// As words in a sentence: `to move object 3`.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::Put { model, .. } => format!("to put a {}", model.category()),
            Self::Move { object, .. } => format!("to move object {object}"),
            Self::Slide { object, .. } => format!("to slide object {object}"),
            Self::Lift { object, .. } => format!("to lift object {object}"),
            Self::Hide { object, .. } => format!("to hide object {object}"),
            Self::Remove { object } => format!("to remove object {object}"),
        }
    }
}

/// One thing to do. Objects are known by their number in the scene, from 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Bring an object and put it down.
    Put {
        /// Which.
        model: ModelChoice,
        /// Where, world x and y, metres.
        to_m: [f64; 2],
    },
    /// Move an object.
    Move {
        /// Which.
        object: u16,
        /// Where to, world x and y, metres.
        to_m: [f64; 2],
    },
    /// Push an object over the table without lifting it; it pushes what it meets.
    Slide {
        /// Which.
        object: u16,
        /// Where to, world x and y, metres.
        to_m: [f64; 2],
    },
    /// Lift an object, hold it for a while, put it back.
    Lift {
        /// Which.
        object: u16,
        /// How long it is held, seconds.
        for_s: f64,
    },
    /// Hold the hand before an object, so that the camera sees it in part.
    Hide {
        /// Which.
        object: u16,
        /// How long, seconds.
        for_s: f64,
    },
    /// Take an object away.
    Remove {
        /// Which.
        object: u16,
    },
}

/// An action and when it begins; later, when the one before has not ended.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedAction {
    /// Seconds from the start of the scene.
    pub at_s: f64,
    /// What to do.
    pub action: Action,
}

/// What a person does.
#[derive(Debug, Clone, PartialEq)]
pub struct PersonPlan {
    /// The script, by time.
    pub script: Vec<TimedAction>,
    /// How fast the hand moves, times the usual.
    pub pace: f64,
    /// Shortest and longest pause between actions by chance, seconds; `None` for
    /// the script alone.
    pub by_chance_every_s: Option<[f64; 2]>,
}

impl Default for PersonPlan {
    /// A person who stands there and does nothing.
    fn default() -> Self {
        Self {
            script: Vec::new(),
            pace: 1.0,
            by_chance_every_s: None,
        }
    }
}

/// The person while the world runs.
#[derive(Debug, Clone)]
pub(crate) struct Person {
    plan: PersonPlan,
    next_in_script: usize,
    chance: Option<Chance>,
    errand: Option<Errand>,
    hand: Point3<f64>,
}

impl Person {
    pub(crate) fn new(plan: PersonPlan, seed: u64) -> Self {
        let chance = plan
            .by_chance_every_s
            .map(|every_s| Chance::new(every_s, seed));
        Self {
            plan,
            next_in_script: 0,
            chance,
            errand: None,
            hand: body::RESTING_HAND,
        }
    }

    /// The body as it is now.
    pub(crate) fn body(&self) -> Body {
        Body::reaching(self.hand)
    }

    /// Position of the hand, world frame.
    pub(crate) fn hand(&self) -> Point3<f64> {
        self.hand
    }

    /// Whether something is being done.
    pub(crate) fn is_busy(&self) -> bool {
        self.errand.is_some()
    }

    /// Goes on for one step of `dt_s`; what the hand does to an object is returned.
    pub(crate) fn step(
        &mut self,
        time_s: f64,
        dt_s: f64,
        around: &dyn Surroundings,
    ) -> Option<HandEvent> {
        if self.errand.is_none() {
            let is_script = self.next_in_script < self.plan.script.len();
            let action = self.due(time_s, around)?;
            self.errand = Errand::new(&action, self.hand, around);
            if self.errand.is_none() && is_script {
                return Some(HandEvent::CanNot(action));
            }
        }
        let errand = self.errand.as_mut()?;
        let event = errand.step(dt_s, self.plan.pace, &mut self.hand);
        if errand.has_ended() {
            self.errand = None;
            if let Some(chance) = &mut self.chance {
                chance.rest_from(time_s);
            }
        }
        event
    }

    fn due(&mut self, time_s: f64, around: &dyn Surroundings) -> Option<Action> {
        if let Some(next) = self.plan.script.get(self.next_in_script) {
            if next.at_s > time_s {
                return None;
            }
            self.next_in_script += 1;
            return Some(next.action.clone());
        }
        self.chance.as_mut()?.due(time_s, around)
    }
}
