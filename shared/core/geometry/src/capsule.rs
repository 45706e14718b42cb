//! Capsule: all points within a radius of a line segment.

use crate::RigidTransform;
use nalgebra::{Point3, Vector3};

/// Capsule (line segment with a radius), metres. Links of an arm and limbs of a person are
/// chains of capsules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// First end of the capsule's axis, metres.
    pub from: Point3<f64>,
    /// Second end of the capsule's axis, metres.
    pub to: Point3<f64>,
    /// Radius of the capsule, metres, >= 0.
    pub radius_m: f64,
}

impl Capsule {
    /// Signed distance of a point from the capsule's surface, metres; negative inside.
    #[inline]
    pub fn distance_m(&self, point: &Point3<f64>) -> f64 {
        let axis: Vector3<f64> = self.to - self.from;
        let length2 = axis.norm_squared();
        let along = if length2 > 0.0 {
            ((point - self.from).dot(&axis) / length2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (point - (self.from + axis * along)).norm() - self.radius_m
    }

    /// Capsule transformed into another frame.
    pub fn transformed(&self, target_from_frame: &RigidTransform) -> Self {
        Self {
            from: target_from_frame * self.from,
            to: target_from_frame * self.to,
            radius_m: self.radius_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_to_the_surface_and_negative_inside() {
        let capsule = Capsule {
            from: Point3::origin(),
            to: Point3::new(1.0, 0.0, 0.0),
            radius_m: 0.1,
        };
        let check = |x, y, expected: f64| {
            let distance = capsule.distance_m(&Point3::new(x, y, 0.0));
            assert!((distance - expected).abs() < 1e-12, "{distance}");
        };
        check(0.5, 0.3, 0.2);
        check(0.5, 0.0, -0.1);
        check(1.3, 0.0, 0.2);
        check(-0.3, 0.4, 0.4);
        let ball = Capsule {
            to: capsule.from,
            ..capsule
        };
        assert!((ball.distance_m(&Point3::new(0.0, 0.5, 0.0)) - 0.4).abs() < 1e-12);
    }
}
