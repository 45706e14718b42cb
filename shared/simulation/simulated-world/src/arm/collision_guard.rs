//! Collision stop: the arm stops before fixtures and at excessive contact force.

use super::{SimulatedArm, in_world};
use crate::physics::{Physics, STEPS_PER_SECOND};
use crate::scene_object::SimulatedObject;
use arm_kinematics::{ArmController, BodyPoses, MotionState};
use nalgebra::Isometry3;

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
    /// contact force. What touches a fixture already may leave it upwards: the far end of a long
    /// object drags over the table while the object turns between the fingers.
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
        let held = self.held_object(objects);
        let is_leaving = held.is_some_and(|held| self.is_leaving(held, before, &now, physics));
        let held = held.filter(|_| !is_leaving);
        [now, stopped]
            .iter()
            .find_map(|poses| self.collision_at(poses, physics, held))
            .or_else(|| self.excess_force(physics))
    }

    /// Message for an arm or held object that penetrates a fixture with the bodies at given poses,
    /// base frame.
    fn collision_at(
        &self,
        poses: &BodyPoses,
        physics: &Physics,
        held: Option<&SimulatedObject>,
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
        let held = held?;
        self.touches_fixture(held, &poses[TOOL_BODY], physics)
            .then(|| {
                format!(
                    "the arm stopped: {} in its hand would have come against the table or the room",
                    held.model.name
                )
            })
    }

    /// Object between the fingers.
    fn held_object<'a>(&self, objects: &'a [SimulatedObject]) -> Option<&'a SimulatedObject> {
        let grasped = self.grasped.as_ref()?;
        objects.iter().find(|object| object.id == grasped.object)
    }

    /// True if a held object touches a fixture with the tool at a pose, world.
    fn touches_fixture(
        &self,
        held: &SimulatedObject,
        world_from_tool: &Isometry3<f64>,
        physics: &Physics,
    ) -> bool {
        self.grasped.as_ref().is_some_and(|grasped| {
            let mut pose = world_from_tool * grasped.gripper_from_object;
            pose.translation.z += TOUCH_M;
            physics.intersects_fixture(&held.model.shape, &pose)
        })
    }

    /// True if a held object touched a fixture before this step, and the hand rises.
    fn is_leaving(
        &self,
        held: &SimulatedObject,
        before: &ArmController,
        now: &BodyPoses,
        physics: &Physics,
    ) -> bool {
        let tool = |poses: &BodyPoses| in_world(poses, &self.world_from_base)[TOOL_BODY];
        let (before, now) = (tool(&before.body_poses()), tool(now));
        now.translation.z > before.translation.z && self.touches_fixture(held, &before, physics)
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
