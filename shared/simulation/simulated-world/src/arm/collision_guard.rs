//! Collision stop: the arm stops before fixtures and at excessive contact force.

use super::SimulatedArm;
use crate::physics::{Physics, STEPS_PER_SECOND};
use crate::scene_object::SimulatedObject;
use arm_kinematics::{ArmController, MotionState};

/// Contact force on an object at which the arm stops, newtons. Chosen.
const MAX_CONTACT_FORCE_N: f64 = 60.0;
/// Penetration depth from which a held object counts as touching a fixture, metres; it may stand
/// on something. Chosen.
const TOUCH_M: f64 = 0.002;
/// Grace period after a new command during which contact force is ignored, steps; it lets a
/// command leave a jam. Chosen.
const GRACE_STEPS: u32 = STEPS_PER_SECOND / 2;
/// Number of bodies that are never tested: base and shoulder stand next to the table and cannot
/// reach it.
const N_FIXED_BODIES: usize = 2;

/// Collision guard: time since the last command, steps.
#[derive(Debug, Clone, Default)]
pub(super) struct CollisionGuard {
    n_steps: u32,
}

impl CollisionGuard {
    /// Restarts the grace period at a new command.
    pub(super) fn begin(&mut self) {
        self.n_steps = 0;
    }
}

impl SimulatedArm {
    /// Collision test of the current step: returns the message for an arm or held object that
    /// would penetrate a fixture, or for excessive contact force.
    pub(super) fn collision_message(
        &mut self,
        before: &ArmController,
        physics: &Physics,
        objects: &[SimulatedObject],
    ) -> Option<String> {
        if self.controller.state() != MotionState::Moving || before == &self.controller {
            return None;
        }
        self.guard.n_steps += 1;
        let moving = self.parts.shapes.iter().zip(self.poses());
        for (index, (shape, pose)) in moving.enumerate().skip(N_FIXED_BODIES) {
            if physics.intersects_fixture(shape, &pose) {
                let part = part_name(index);
                return Some(format!(
                    "the arm stopped: its {part} would have hit the table or the room"
                ));
            }
        }
        self.held_object_collision(physics, objects)
            .or_else(|| self.excess_force(physics))
    }

    fn held_object_collision(
        &self,
        physics: &Physics,
        objects: &[SimulatedObject],
    ) -> Option<String> {
        let grasped = self.grasped.as_ref()?;
        let object = objects.iter().find(|object| object.id == grasped.object)?;
        let mut pose = self.world_from_gripper() * grasped.gripper_from_object;
        pose.translation.z += TOUCH_M;
        physics
            .intersects_fixture(&object.model.shape, &pose)
            .then(|| {
                format!(
                    "the arm stopped: {} in its hand has come against the table or the room",
                    object.model.name
                )
            })
    }

    fn excess_force(&self, physics: &Physics) -> Option<String> {
        if self.guard.n_steps < GRACE_STEPS {
            return None;
        }
        let (index, force_n) = self
            .bodies
            .iter()
            .map(|&body| physics.contact_force_n(body))
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        (force_n > MAX_CONTACT_FORCE_N).then(|| {
            format!(
                "the arm stopped: its {} presses on an object with {force_n:.0} N",
                part_name(index)
            )
        })
    }
}

fn part_name(index: usize) -> &'static str {
    match index {
        0..=6 => [
            "base",
            "shoulder",
            "upper arm",
            "forearm",
            "wrist",
            "wrist",
            "hand",
        ][index],
        7 => "palm",
        _ => "finger",
    }
}
