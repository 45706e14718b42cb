//! Disturbance of an object that was not to be moved.

use geometry::RigidTransform;
use nalgebra::Vector3;

/// Distance by which an object is moved from which on it was disturbed, metres.
const MOVED_M: f64 = 0.010;
/// Angle by which an object is tipped from which on it was disturbed, radians.
pub const TIPPED_RAD: f64 = 0.17;

/// True if an object was moved by more than a centimetre, or tipped.
pub fn is_disturbed(before: &RigidTransform, after: &RigidTransform) -> bool {
    let moved_m = (after.translation.vector - before.translation.vector).norm();
    moved_m > MOVED_M || tipped_rad(before, after) > TIPPED_RAD
}

/// Angle between the vertical of the object before and after, radians.
pub fn tipped_rad(before: &RigidTransform, after: &RigidTransform) -> f64 {
    let up_in_object = before.rotation.inverse() * Vector3::z();
    (after.rotation * up_in_object).angle(&Vector3::z())
}
