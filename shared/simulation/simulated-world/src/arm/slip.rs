//! Slip of a held object: it turns between the pads or slides out of them under its weight and its
//! acceleration.

use super::holding_law::Holding;
use super::{STEP_S, SimulatedArm};
use crate::physics::Physics;
use crate::scene_object::SimulatedObject;
use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// Acceleration of gravity, m/s².
const GRAVITY_M_S2: f64 = 9.81;
/// Speed at which an object turns between the pads, rad/s. Chosen: that of a fork that swings down.
const TURN_RAD_S: f64 = 3.0;

/// Distance over the table within which it carries a held object, metres. Chosen.
const SUPPORTED_M: f64 = 0.001;

/// Motion of the centre of mass of a held object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeldMotion {
    place: Point3<f64>,
    velocity_m_s: Vector3<f64>,
}

impl SimulatedArm {
    /// Lets the held object turn or slide by the holding law. Must be called when the arm has made
    /// its step.
    pub(super) fn slip(&mut self, physics: &mut Physics, objects: &mut [SimulatedObject]) {
        let world_from_gripper = self.world_from_gripper();
        let Some(grasped) = &mut self.grasped else {
            return;
        };
        let (in_object, mass_kg) = physics.mass_in_body(grasped.body);
        let place = world_from_gripper * grasped.gripper_from_object * in_object;
        let before = grasped.motion.unwrap_or(HeldMotion {
            place,
            velocity_m_s: Vector3::zeros(),
        });
        let velocity_m_s = (place - before.place) / STEP_S;
        let acceleration_m_s2 = (velocity_m_s - before.velocity_m_s) / STEP_S;
        let down = -Vector3::z() * GRAVITY_M_S2;
        let load_n = mass_kg * (down - acceleration_m_s2);
        // Law and load in the frame of the gripper.
        let gripper_from_world = world_from_gripper.inverse();
        let load_in_gripper = gripper_from_world.rotation * load_n;
        let at = gripper_from_world * place;
        grasped.motion = Some(HeldMotion {
            place,
            velocity_m_s,
        });
        let held = grasped.law.under(&load_in_gripper, &at);
        if held == Holding::Fast || self.is_supported(physics, objects) {
            return;
        }
        match held {
            Holding::Fast => {}
            Holding::Turns(torque) => self.turn(torque, physics, objects),
            Holding::Slides => {
                let name = self.held_name(objects).unwrap_or_default();
                self.release(physics, objects);
                self.halt(format!(
                    "the arm stopped: {name} slipped out of its fingers"
                ));
            }
        }
    }

    /// True while the held object stands on the table, which carries it.
    fn is_supported(&self, physics: &Physics, objects: &[SimulatedObject]) -> bool {
        let Some(grasped) = &self.grasped else {
            return false;
        };
        let object = objects.iter().find(|object| object.id == grasped.object);
        let mut pose = self.world_from_gripper() * grasped.gripper_from_object;
        pose.translation.z -= SUPPORTED_M;
        object.is_some_and(|object| physics.intersects_fixture(&object.model.shape, &pose))
    }

    /// Turns the held object about the line between the pads, unless it would go into the table.
    fn turn(&mut self, torque: f64, physics: &Physics, objects: &[SimulatedObject]) {
        let world_from_gripper = self.world_from_gripper();
        let Some(grasped) = &mut self.grasped else {
            return;
        };
        let Some(axis) = Unit::try_new(grasped.law.axis(), 1e-9) else {
            return;
        };
        let angle_rad = torque.signum() * TURN_RAD_S * STEP_S;
        let middle = Translation3::from(grasped.law.middle().coords);
        let turn = UnitQuaternion::from_axis_angle(&axis, angle_rad);
        let turned = middle * turn * middle.inverse() * grasped.gripper_from_object;
        let pose = world_from_gripper * turned;
        let object = objects.iter().find(|object| object.id == grasped.object);
        if object.is_some_and(|object| !physics.intersects_fixture(&object.model.shape, &pose)) {
            // The motion of its centre by the turn is slow, and no acceleration that counts.
            let (in_object, _) = physics.mass_in_body(grasped.body);
            if let Some(motion) = &mut grasped.motion {
                motion.place = pose * in_object;
            }
            grasped.gripper_from_object = turned;
        }
    }

    fn held_name(&self, objects: &[SimulatedObject]) -> Option<String> {
        let grasped = self.grasped.as_ref()?;
        let object = objects.iter().find(|object| object.id == grasped.object)?;
        Some(object.model.name.clone())
    }
}
