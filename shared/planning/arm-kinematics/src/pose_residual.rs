//! Residual between two poses: distance and rotation angle.

use geometry::RigidTransform;

use crate::IkConfig;

/// Difference of two poses: distance and rotation angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseResidual {
    /// Distance between the origins of the poses, metres.
    pub distance_m: f64,
    /// Angle of the rotation between them, radians, 0 to π.
    pub angle_rad: f64,
}

impl PoseResidual {
    /// Residual between the poses `a` and `b`.
    pub fn between(a: &RigidTransform, b: &RigidTransform) -> Self {
        Self {
            distance_m: (a.translation.vector - b.translation.vector).norm(),
            angle_rad: a.rotation.angle_to(&b.rotation),
        }
    }

    pub(crate) fn is_within(&self, config: &IkConfig) -> bool {
        self.distance_m <= config.tolerance_m && self.angle_rad <= config.tolerance_rad
    }

    /// Weighted norm, metres: one radian counts as 0.2 m, the displacement of a fingertip.
    /// Chosen.
    pub(crate) fn weighted_norm_m(&self) -> f64 {
        self.distance_m.hypot(0.2 * self.angle_rad)
    }
}
