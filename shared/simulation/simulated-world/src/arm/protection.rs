//! When the arm stops by itself: before table and walls, and when it presses.

use super::SimulatedArm;
use crate::physics::{Physics, STEPS_PER_SECOND};
use crate::world::SceneObject;
use arm_kinematics::{ArmMotion, MotionState};

/// The arm stops when it presses harder than this on an object, newtons.
const PRESSING_MAX_N: f64 = 60.0;
/// What is held may stand on something: it counts as touching when it reaches
/// farther in than this, metres.
const TOUCH_M: f64 = 0.002;
/// A new command may leave a jam: pressing is ignored for this long, steps.
const FREEING_STEPS: u32 = STEPS_PER_SECOND / 2;
/// Base, shoulder: they stand beside the table and can not reach it.
const N_FIXED_BODIES: usize = 2;

/// Steps since the last command.
#[derive(Debug, Clone, Default)]
pub(super) struct Guard {
    n_steps: u32,
}

impl Guard {
    /// A new command has come.
    pub(super) fn begin(&mut self) {
        self.n_steps = 0;
    }
}

impl SimulatedArm {
    /// The sentence for which the motion of this step must not be: what the arm
    /// or what it holds would reach into, or what it presses on.
    pub(super) fn obstacle(
        &mut self,
        before: &ArmMotion,
        physics: &Physics,
        objects: &[SceneObject],
    ) -> Option<String> {
        if self.motion.state() != MotionState::Moving || before == &self.motion {
            return None;
        }
        self.guard.n_steps += 1;
        let moving = self.parts.shapes.iter().zip(self.poses());
        for (index, (shape, pose)) in moving.enumerate().skip(N_FIXED_BODIES) {
            if physics.hits_fixture(shape, &pose) {
                let part = part_name(index);
                return Some(format!(
                    "the arm stopped: its {part} would have hit the table or the room"
                ));
            }
        }
        self.held_obstacle(physics, objects)
            .or_else(|| self.pressing(physics))
    }

    fn held_obstacle(&self, physics: &Physics, objects: &[SceneObject]) -> Option<String> {
        let gripped = self.gripped.as_ref()?;
        let object = objects.iter().find(|object| object.id == gripped.object)?;
        let mut pose = self.world_from_gripper() * gripped.gripper_from_object;
        pose.translation.z += TOUCH_M;
        physics.hits_fixture(&object.model.shape, &pose).then(|| {
            format!(
                "the arm stopped: {} in its hand has come against the table or the room",
                object.model.name
            )
        })
    }

    fn pressing(&self, physics: &Physics) -> Option<String> {
        if self.guard.n_steps < FREEING_STEPS {
            return None;
        }
        let (index, force_n) = self
            .bodies
            .iter()
            .map(|&body| physics.pressing_n(body))
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        (force_n > PRESSING_MAX_N).then(|| {
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
