//! Random actions of a person without a script.

use crate::action::Action;
use crate::random_stream::random_stream;
use crate::world::World;
use random::Random;

/// Least number of objects that a person leaves on the table. Chosen.
const MIN_OBJECTS: usize = 3;
/// Number of objects from which a person brings no more. Chosen.
const MAX_TABLE_OBJECTS: usize = 8;
/// Random stream of the person's actions.
const STREAM_ACTIONS: u64 = 3;

/// Generator of random actions with random pauses.
#[derive(Debug, Clone)]
pub(crate) struct RandomActions {
    every_s: [f64; 2],
    random: Random,
    next_s: f64,
}

impl RandomActions {
    pub(crate) fn new(every_s: [f64; 2], seed: u64) -> Self {
        let mut chance = Self {
            every_s,
            random: random_stream(seed, STREAM_ACTIONS),
            next_s: 0.0,
        };
        chance.rest_from(0.0);
        chance
    }

    /// Starts a new random pause of the person.
    pub(crate) fn rest_from(&mut self, time_s: f64) {
        let [shortest, longest] = self.every_s;
        self.next_s = time_s + self.random.between(shortest, longest);
    }

    /// Next action, if the pause is over and an action is possible.
    pub(crate) fn due(&mut self, time_s: f64, world: &World) -> Option<Action> {
        if time_s < self.next_s {
            return None;
        }
        self.rest_from(time_s);
        let free = world.free_objects();
        let draw = self.random.next_u64();
        match self.random.unit() {
            p if p < 0.25 && free.len() < MAX_TABLE_OBJECTS => Some(Action::Put {
                model: world.random_model(draw)?,
                to_m: world.free_position(None, draw)?,
            }),
            p if p < 0.40 && free.len() > MIN_OBJECTS => Some(Action::Remove {
                object: *self.random.choice(&free)?,
            }),
            p if p < 0.50 => Some(Action::Lift {
                object: *self.random.choice(&free)?,
                for_s: 1.5,
            }),
            p if p < 0.58 => Some(Action::Hide {
                object: *self.random.choice(&free)?,
                for_s: 2.0,
            }),
            _ => {
                let object = *self.random.choice(&free)?;
                Some(Action::Move {
                    object,
                    to_m: world.free_position(Some(object), draw)?,
                })
            }
        }
    }
}
