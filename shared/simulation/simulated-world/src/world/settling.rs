//! Settling of dropped objects before the scene starts.

use super::World;
use crate::physics::STEPS_PER_SECOND;
use crate::scene::ObjectPlacement;
use crate::scene_object::ObjectState;
use std::sync::Arc;

/// Time limit of settling, steps; slower objects stay in motion. Chosen.
const MAX_SETTLE_STEPS: u32 = 6 * STEPS_PER_SECOND;
/// Interval of the rest checks, steps. Chosen.
const CHECK_STEPS: u32 = STEPS_PER_SECOND / 4;
/// Number of consecutive checks at rest; a tipping object is slow at first. Chosen.
const CHECKS_AT_REST: u32 = 3;
/// Number of times that fallen objects are dropped again. Chosen.
const MAX_DROPS: u32 = 3;
/// Share of its distance from the middle at which an object that fell off is lowered again. Chosen.
const INWARDS_SHARE: f64 = 0.75;

impl World {
    /// Lets all objects come to rest, drops fallen ones again, and reports those that remain on
    /// the floor.
    pub(super) fn settle(&mut self) {
        self.run_until_rest();
        for n_drops in 1..=MAX_DROPS {
            let share_from_middle = INWARDS_SHARE.powi(n_drops.cast_signed());
            if !self.drop_fallen_again(share_from_middle) {
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

    /// Drops fallen objects again; returns true if there were any. A lowered object is lowered at
    /// this share of its distance from the middle of the table.
    fn drop_fallen_again(&mut self, share_from_middle: f64) -> bool {
        let mut has_dropped = false;
        for index in 0..self.objects.len() {
            let object = &self.objects[index];
            if object.state != ObjectState::OnFloor {
                continue;
            }
            let (body, model) = (object.body, Arc::clone(&object.model));
            let pose = match self.scene.objects[index].placement {
                ObjectPlacement::Upright { .. } => continue,
                ObjectPlacement::Dropped { world_from_object } => world_from_object,
                ObjectPlacement::Lowered {
                    position_m,
                    rotation,
                } => {
                    let inwards_m = position_m.map(|value| value * share_from_middle);
                    self.lowered_pose(&model, inwards_m, &rotation)
                }
            };
            self.physics.place(body, &pose);
            self.run_physics(super::DROP_STEPS);
            has_dropped = true;
        }
        has_dropped
    }
}
