//! What a person without a script does next.

use super::{Action, Surroundings};
use crate::chance;
use random::Random;

/// Fewest and most objects a person leaves on the table.
const OBJECTS_LEFT: usize = 3;
const OBJECTS_MOST: usize = 8;
/// Purpose of the random stream.
const CHANCE: u64 = 3;

/// Now and then something, by chance.
#[derive(Debug, Clone)]
pub(crate) struct Chance {
    every_s: [f64; 2],
    random: Random,
    next_s: f64,
}

impl Chance {
    pub(crate) fn new(every_s: [f64; 2], seed: u64) -> Self {
        let mut chance = Self {
            every_s,
            random: chance::stream(seed, CHANCE),
            next_s: 0.0,
        };
        chance.rest_from(0.0);
        chance
    }

    /// Waits from now on.
    pub(crate) fn rest_from(&mut self, time_s: f64) {
        let [shortest, longest] = self.every_s;
        self.next_s = time_s + self.random.between(shortest, longest);
    }

    /// What to do now, if it is time and something can be done.
    pub(crate) fn due(&mut self, time_s: f64, around: &dyn Surroundings) -> Option<Action> {
        if time_s < self.next_s {
            return None;
        }
        self.rest_from(time_s);
        let free = around.free_objects();
        let draw = self.random.next_u64();
        match self.random.unit() {
            p if p < 0.25 && free.len() < OBJECTS_MOST => Some(Action::Put {
                model: around.another_model(draw)?,
                to_m: around.free_spot(None, draw)?,
            }),
            p if p < 0.40 && free.len() > OBJECTS_LEFT => Some(Action::Remove {
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
                    to_m: around.free_spot(Some(object), draw)?,
                })
            }
        }
    }
}
