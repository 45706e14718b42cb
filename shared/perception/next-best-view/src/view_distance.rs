//! Distance between camera poses, and the weight that falls with it.

use geometry::RigidTransform;
use nalgebra::Point3;

/// Metric on camera poses: translation, and rotation on the circle of the cameras.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewMetric {
    rotation_radius_m: f64,
}

impl ViewMetric {
    /// Metric of cameras around a place: a rotation counts as the way on a circle with their mean
    /// distance from it.
    pub fn around(middle_in_world: &Point3<f64>, world_from_cameras: &[RigidTransform]) -> Self {
        let distance_m =
            |pose: &RigidTransform| (pose.translation.vector - middle_in_world.coords).norm();
        let sum_m: f64 = world_from_cameras.iter().map(distance_m).sum();
        Self {
            rotation_radius_m: sum_m / world_from_cameras.len().max(1) as f64,
        }
    }

    /// Distance `sqrt(|t_a - t_b|^2 + (radius * angle)^2)`, metres.
    pub fn distance_m(&self, a: &RigidTransform, b: &RigidTransform) -> f64 {
        let translation_m = (a.translation.vector - b.translation.vector).norm();
        // The arc cosine of `angle_to` would lose small angles.
        let turn = a.rotation.inverse() * b.rotation;
        let angle = 2.0 * turn.imag().norm().atan2(turn.w.abs());
        translation_m.hypot(self.rotation_radius_m * angle)
    }

    /// Diameter of a set of poses, from below: the pose farthest from the first one, and the
    /// distance of the one farthest from that. 0 for fewer than two poses.
    pub fn diameter_m(&self, poses: &[RigidTransform]) -> f64 {
        let farthest = |from: &RigidTransform| {
            let distances = poses.iter().map(|pose| (self.distance_m(from, pose), pose));
            distances.max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let Some((_, end)) = poses.first().and_then(farthest) else {
            return 0.0;
        };
        farthest(end).map_or(0.0, |(distance_m, _)| distance_m)
    }
}

/// Gaussian weight of a distance (Kasaei et al. 2018, equation 3), without the factor that all
/// views share; 1 for a deviation of 0.
pub(crate) fn gaussian_weight(distance_m: f64, sigma_m: f64) -> f64 {
    if sigma_m > 0.0 {
        (-0.5 * (distance_m / sigma_m).powi(2)).exp()
    } else {
        1.0
    }
}

/// Weight that rises from 0 at a visited view to 1 far from it; 1 for a deviation of 0.
pub(crate) fn novelty_weight(distance_m: f64, sigma_m: f64) -> f64 {
    if sigma_m > 0.0 {
        1.0 - gaussian_weight(distance_m, sigma_m)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion, Vector3};

    fn pose(x: f64, yaw: f64) -> RigidTransform {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        RigidTransform::from_parts(Translation3::new(x, 0.0, 0.0), rotation)
    }

    #[test]
    fn translation_and_rotation_are_metres_of_one_kind() {
        let metric = ViewMetric::around(&Point3::origin(), &[pose(2.0, 0.0), pose(-2.0, 0.0)]);
        assert!((metric.distance_m(&pose(0.0, 0.0), &pose(3.0, 0.0)) - 3.0).abs() < 1e-12);
        assert!((metric.distance_m(&pose(0.0, 0.0), &pose(0.0, 1e-9)) - 2e-9).abs() < 1e-15);
        assert!((metric.distance_m(&pose(0.0, 0.2), &pose(3.0, 2.2)) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn diameter_is_the_distance_of_the_ends() {
        let metric = ViewMetric::around(&Point3::origin(), &[]);
        let poses = [0.3, -0.2, 1.1, 0.5].map(|x| pose(x, 0.0));
        assert!((metric.diameter_m(&poses) - 1.3).abs() < 1e-12);
        assert_eq!(metric.diameter_m(&poses[..1]), 0.0);
        assert_eq!(metric.diameter_m(&[]), 0.0);
    }

    #[test]
    fn weight_falls_by_the_normal_law() {
        assert_eq!(gaussian_weight(0.0, 0.5), 1.0);
        assert!((gaussian_weight(0.5, 0.5) - (-0.5_f64).exp()).abs() < 1e-12);
        assert!(gaussian_weight(1.0, 0.5) < gaussian_weight(0.9, 0.5));
        assert_eq!(gaussian_weight(1.0, 0.0), 1.0);
        assert_eq!(
            (novelty_weight(0.0, 0.5), novelty_weight(0.0, 0.0)),
            (0.0, 1.0)
        );
        assert!((novelty_weight(0.5, 0.5) + gaussian_weight(0.5, 0.5) - 1.0).abs() < 1e-12);
    }
}
