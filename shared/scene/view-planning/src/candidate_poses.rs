//! Candidate camera poses, evenly spread over the upper hemisphere around the objects.

use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};

/// Angle between one candidate and the next about the vertical, radians: the golden angle, by which
/// places on a sphere are spread evenly (Vogel 1979).
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// Horizontal part of a line of sight below which it is vertical.
const VERTICAL: f64 = 1e-6;

/// Cameras at a distance from the origin that look at it with the image upright, of least elevation
/// first; z is up.
pub fn hemisphere(
    n_candidates: usize,
    distance_m: f64,
    elevation_min_rad: f64,
) -> Vec<RigidTransform> {
    let least = elevation_min_rad.sin();
    let pose = |i: usize| {
        let share = (i as f64 + 0.5) / n_candidates as f64;
        let z = least + (1.0 - least) * share;
        let ring = (1.0 - z * z).max(0.0).sqrt();
        let angle = i as f64 * GOLDEN_ANGLE;
        let direction = Vector3::new(ring * angle.cos(), ring * angle.sin(), z);
        looking_at_origin(&(direction * distance_m).into())
    };
    (0..n_candidates).map(pose).collect()
}

/// Camera that looks at the origin with the image upright; a camera above it has the top of its
/// image towards y.
fn looking_at_origin(eye: &Point3<f64>) -> RigidTransform {
    let is_above = eye.coords.xy().norm() < VERTICAL * eye.coords.norm();
    let down = if is_above {
        -Vector3::y()
    } else {
        -Vector3::z()
    };
    RigidTransform::face_towards(eye, &Point3::origin(), &down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_look_at_the_middle_from_above_with_the_image_upright() {
        let least = 20.0_f64.to_radians();
        let poses = hemisphere(100, 0.8, least);
        assert_eq!(poses.len(), 100);
        for pose in &poses {
            let eye = pose.translation.vector;
            assert!((eye.norm() - 0.8).abs() < 1e-9);
            assert!((eye.z / 0.8).asin() > least, "{eye:?}");
            let axis = pose.rotation * Vector3::z();
            assert!((axis + eye / 0.8).norm() < 1e-9);
            let right = pose.rotation * Vector3::x();
            assert!(right.z.abs() < 1e-9, "level: {right:?}");
            assert!((pose.rotation * Vector3::y()).z < 0.0, "image y is down");
        }
        // Evenly: each has a neighbour, and none is much nearer than the mean area allows.
        let nearest = |pose: &RigidTransform| {
            let others = poses.iter().filter(|other| *other != pose);
            let distances = others.map(|o| (o.translation.vector - pose.translation.vector).norm());
            distances.fold(f64::INFINITY, f64::min)
        };
        let distances: Vec<f64> = poses.iter().map(nearest).collect();
        let area_m2 = std::f64::consts::TAU * 0.8 * 0.8 * (1.0 - least.sin()) / 100.0;
        let bounds = 0.6 * area_m2.sqrt()..1.3 * area_m2.sqrt();
        assert!(
            distances.iter().all(|d| bounds.contains(d)),
            "{distances:?}"
        );
    }

    #[test]
    fn camera_straight_above_has_a_finite_pose() {
        let pose = looking_at_origin(&Point3::new(0.0, 0.0, 1.0));
        assert!((pose.rotation * Vector3::z() + Vector3::z()).norm() < 1e-9);
        assert!((pose.rotation * Vector3::y() + Vector3::y()).norm() < 1e-9);
    }
}
