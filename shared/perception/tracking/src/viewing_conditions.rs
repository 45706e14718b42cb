//! Viewing conditions of a measurement: distance, ray, depth noise, truncation and hand
//! contact.

use nalgebra::{Unit, Vector3};
use sensor_noise::DepthNoise;

/// Contact of an object with a hand, human or robotic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandContact {
    /// No hand is near the object.
    None,
    /// Hand that touches the object and may be moving it.
    Touching,
    /// Hand whose points overlap the object's: some of them may be the hand's.
    Overlapping,
}

/// Viewing conditions of a measured object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewingConditions {
    /// Depth of the object along the optical axis, metres.
    pub depth_m: f64,
    /// Depth noise law of the camera.
    pub depth_noise: DepthNoise,
    /// Unit ray from the camera to the object, world frame.
    pub ray_in_world: Unit<Vector3<f64>>,
    /// Variances of the object's points along the axes of its box, square metres.
    pub variances_m2: Vector3<f64>,
    /// `true` when the object is seen to stand on the table, so that its box ends there.
    pub stands_on_table: bool,
    /// `true` when a part may be missing: truncated by the image border or covered by a
    /// touching body.
    pub is_truncated: bool,
    /// Hand contact as reported by detection.
    pub hand_contact: HandContact,
}

impl ViewingConditions {
    /// Standard deviation of the depth of the object's points, metres.
    pub(crate) fn depth_sigma_m(&self) -> f64 {
        self.depth_noise.bounded_sigma_m(self.depth_m)
    }

    /// True if a hand may be moving the object.
    pub fn is_handled(&self) -> bool {
        self.hand_contact != HandContact::None
    }
}
