//! Pose of a commanded motion, checked.

use geometry::RigidTransform;
use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};

/// Tolerance of a quaternion's norm. Chosen.
const UNIT_TOLERANCE: f64 = 1e-2;

/// Pose of a motion: position, metres, and orientation as a quaternion x, y, z, w.
///
/// # Errors
/// A sentence when its numbers are no pose.
pub fn commanded_pose(
    position_m: [f64; 3],
    [x, y, z, w]: [f64; 4],
) -> Result<RigidTransform, String> {
    let quaternion = Quaternion::new(w, x, y, z);
    let is_unit = (quaternion.norm() - 1.0).abs() < UNIT_TOLERANCE;
    if !is_unit || !position_m.iter().all(|v| v.is_finite()) {
        return Err(format!(
            "the pose at {position_m:?} with orientation {:?} is none: positions are finite, \
             an orientation x, y, z, w has length 1",
            [x, y, z, w]
        ));
    }
    Ok(RigidTransform::from_parts(
        Translation3::from(Vector3::from(position_m)),
        UnitQuaternion::new_normalize(quaternion),
    ))
}
