//! Settling of dropped objects before the scene starts.

use super::World;
use crate::physics::STEPS_PER_SECOND;
use crate::scene::ObjectPlacement;
use crate::scene_object::ObjectState;

/// Time limit of settling, steps; slower objects stay in motion. Chosen.
const MAX_SETTLE_STEPS: u32 = 6 * STEPS_PER_SECOND;
/// Interval of the rest checks, steps. Chosen.
const CHECK_STEPS: u32 = STEPS_PER_SECOND / 4;
/// Number of consecutive checks at rest; a tipping object is slow at first. Chosen.
const CHECKS_AT_REST: u32 = 3;
/// Number of times that fallen objects are dropped again. Chosen.
const MAX_DROPS: u32 = 3;

impl World {
    /// Lets all objects come to rest, drops fallen ones again, and reports those that remain on
    /// the floor.
    pub(super) fn settle(&mut self) {
        self.run_until_rest();
        for _ in 0..MAX_DROPS {
            if !self.drop_fallen_again() {
                break;
            }
            self.run_until_rest();
        }
        self.report_falls();
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
        let mut n_checks_at_rest = 0;
        for _ in 0..MAX_SETTLE_STEPS / CHECK_STEPS {
            self.run_physics(CHECK_STEPS);
            let moves = self.objects.iter().any(|o| o.state == ObjectState::Moving);
            n_checks_at_rest = if moves { 0 } else { n_checks_at_rest + 1 };
            if n_checks_at_rest == CHECKS_AT_REST {
                return;
            }
        }
    }

    /// Drops fallen objects again; returns true if there were any.
    fn drop_fallen_again(&mut self) -> bool {
        let mut has_dropped = false;
        for index in 0..self.objects.len() {
            let object = &self.objects[index];
            let plan = &self.scene.objects[index];
            if let (ObjectState::OnFloor, ObjectPlacement::Dropped { world_from_object }) =
                (object.state, &plan.placement)
            {
                let (body, pose) = (object.body, *world_from_object);
                self.physics.place(body, &pose);
                self.run_physics(super::DROP_STEPS);
                has_dropped = true;
            }
        }
        has_dropped
    }
}
