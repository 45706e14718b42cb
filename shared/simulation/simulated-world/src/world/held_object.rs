//! Object in the person's hand.

use crate::ObjectModel;
use geometry::RigidTransform;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

/// Object that follows the hand, and turns only with [`turn`](Self::turn).
#[derive(Debug, Clone)]
pub(crate) struct HeldObject {
    pub(crate) object: u16,
    /// Object pose in a frame at the hand with the axes of the world.
    hand_from_object: RigidTransform,
}

impl HeldObject {
    /// Grasps an object at its current pose.
    pub(crate) fn new(object: u16, hand: &Point3<f64>, world_from_object: &RigidTransform) -> Self {
        Self {
            object,
            hand_from_object: Translation3::from(hand.coords).inverse() * world_from_object,
        }
    }

    /// Turns the object about the vertical through the hand, counter-clockwise from above.
    pub(crate) fn turn(&mut self, angle_rad: f64) {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle_rad);
        self.hand_from_object = turn * self.hand_from_object;
    }

    pub(crate) fn world_from_object(&self, hand: &Point3<f64>) -> RigidTransform {
        Translation3::from(hand.coords) * self.hand_from_object
    }
}

/// Pose of an object that a hand has brought: upright, its top below the hand.
pub(crate) fn carried_below(hand: &Point3<f64>, model: &ObjectModel) -> RigidTransform {
    let grip_m = crate::person::GRIP_M;
    let down = Translation3::new(0.0, 0.0, -model.half_sides_m.z - grip_m);
    RigidTransform::from_parts(
        Translation3::from(hand.coords) * down,
        UnitQuaternion::identity(),
    )
}
