//! An object in a person's hand.

use crate::ObjectModel;
use geometry::RigidTransform;
use nalgebra::{Point3, Translation3, UnitQuaternion};

/// An object that follows the hand without turning.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub(crate) object: u16,
    /// Pose of the object in a frame at the hand with the world's axes.
    hand_from_object: RigidTransform,
}

impl Held {
    /// Takes hold of an object where it is.
    pub(crate) fn new(object: u16, hand: &Point3<f64>, world_from_object: &RigidTransform) -> Self {
        Self {
            object,
            hand_from_object: Translation3::from(hand.coords).inverse() * world_from_object,
        }
    }

    pub(crate) fn world_from_object(&self, hand: &Point3<f64>) -> RigidTransform {
        Translation3::from(hand.coords) * self.hand_from_object
    }
}

/// The pose of an object that a hand has brought: upright, its top under the hand.
pub(crate) fn carried_below(hand: &Point3<f64>, model: &ObjectModel) -> RigidTransform {
    let grip_m = crate::person::GRIP_M;
    let down = Translation3::new(0.0, 0.0, -model.half_sides_m.z - grip_m);
    RigidTransform::from_parts(
        Translation3::from(hand.coords) * down,
        UnitQuaternion::identity(),
    )
}
