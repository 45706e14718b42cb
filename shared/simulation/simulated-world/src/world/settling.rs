//! Letting thrown objects come to rest before anybody looks.

use super::{ObjectState, World};
use crate::physics::STEPS_PER_SECOND;
use crate::scene::Placing;

/// Objects that have not come to rest after this long are left moving, steps.
const MOST_STEPS: u32 = 6 * STEPS_PER_SECOND;
/// How often it is looked whether all are at rest, steps.
const LOOK_STEPS: u32 = STEPS_PER_SECOND / 4;
/// What begins to tip is slow at first: rest must last for so many looks.
const LOOKS_AT_REST: u32 = 3;
/// How often an object that has fallen off the table is thrown again.
const MOST_THROWS: u32 = 3;

impl World {
    /// Lets all objects come to rest; what fell off is thrown again, and in the
    /// end told.
    pub(super) fn settle(&mut self) {
        self.run_until_rest();
        for _ in 0..MOST_THROWS {
            if !self.throw_fallen_again() {
                break;
            }
            self.run_until_rest();
        }
        self.notice_falls();
        let moving = self
            .objects
            .iter()
            .filter(|o| o.state == ObjectState::Moving);
        let names: Vec<_> = moving.map(|o| o.model.name.as_str()).collect();
        if !names.is_empty() {
            let note = format!("still moving when the scene begins: {}", names.join(", "));
            self.notes.push(note);
        }
    }

    fn run_until_rest(&mut self) {
        let mut n_looks_at_rest = 0;
        for _ in 0..MOST_STEPS / LOOK_STEPS {
            self.run_physics(LOOK_STEPS);
            let moves = self.objects.iter().any(|o| o.state == ObjectState::Moving);
            n_looks_at_rest = if moves { 0 } else { n_looks_at_rest + 1 };
            if n_looks_at_rest == LOOKS_AT_REST {
                return;
            }
        }
    }

    /// Whether there was anything to throw.
    fn throw_fallen_again(&mut self) -> bool {
        let mut has_thrown = false;
        for index in 0..self.objects.len() {
            let object = &self.objects[index];
            let plan = &self.scene.objects[index];
            if let (ObjectState::OnFloor, Placing::Dropped { world_from_object }) =
                (object.state, &plan.placing)
            {
                let (body, pose) = (object.body, *world_from_object);
                self.physics.place(body, &pose);
                self.run_physics(super::DROP_STEPS);
                has_thrown = true;
            }
        }
        has_thrown
    }
}
