//! Collision stop: the arm stops before fixtures and at excessive contact force.

use super::{SimulatedArm, in_world};
use crate::physics::{Physics, STEPS_PER_SECOND};
use crate::scene_object::SimulatedObject;
use arm_kinematics::{ArmController, BodyPoses, MotionState};

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
/// Place of the rail, whose pose is that of the gripper, among the bodies.
const TOOL_BODY: usize = 7;

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
    /// would penetrate a fixture, now or where the arm stands if it brakes now, or for excessive
    /// contact force.
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
        let now = self.controller.body_poses();
        let stopped = self.controller.stopped_body_poses();
        [now, stopped]
            .iter()
            .find_map(|poses| self.collision_at(poses, physics, objects))
            .or_else(|| self.excess_force(physics))
    }

    /// Message for an arm or held object that penetrates a fixture with the bodies at given poses,
    /// base frame.
    fn collision_at(
        &self,
        poses: &BodyPoses,
        physics: &Physics,
        objects: &[SimulatedObject],
    ) -> Option<String> {
        let poses = in_world(poses, &self.world_from_base);
        let bodies = self.parts.shapes.iter().zip(&poses).enumerate();
        let mut tested = bodies.skip(N_FIXED_BODIES);
        let hit = tested.find(|(_, (shape, pose))| physics.intersects_fixture(shape, pose));
        if let Some((index, _)) = hit {
            let part = part_name(index);
            return Some(format!(
                "the arm stopped: its {part} would have hit the table or the room"
            ));
        }
        let grasped = self.grasped.as_ref()?;
        let object = objects.iter().find(|object| object.id == grasped.object)?;
        let mut pose = poses[TOOL_BODY] * grasped.gripper_from_object;
        pose.translation.z += TOUCH_M;
        physics
            .intersects_fixture(&object.model.shape, &pose)
            .then(|| {
                format!(
                    "the arm stopped: {} in its hand would have come against the table or the room",
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
