//! Camera mount: look-at pose on a sphere around a target point.

use geometry::RigidTransform;
use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Camera mount: spherical coordinates around the point it looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraMount {
    /// Target point of the camera, world frame, metres.
    pub look_at_m: [f64; 3],
    /// Distance of the camera from the target point, metres.
    pub distance_m: f64,
    /// Elevation above the horizon, degrees, -89 to 89.
    pub elevation_deg: f64,
    /// Azimuth around the target point, degrees: 0 at the near side (-y), 90 at +x.
    pub azimuth_deg: f64,
    /// Orbit speed of the camera, degrees per second.
    pub orbit_deg_s: f64,
}

impl Default for CameraMount {
    fn default() -> Self {
        Self {
            look_at_m: [0.0, -0.02, 0.74],
            distance_m: 1.0,
            elevation_deg: 43.0,
            azimuth_deg: 4.0,
            orbit_deg_s: 0.0,
        }
    }
}

impl CameraMount {
    /// Camera pose (x right, y down, z forward) at a time, seconds.
    pub fn world_from_camera(&self, time_s: f64) -> RigidTransform {
        let elevation = self.elevation_deg.to_radians();
        let azimuth = (self.azimuth_deg + self.orbit_deg_s * time_s).to_radians();
        let (sin_e, cos_e) = elevation.sin_cos();
        let (sin_a, cos_a) = azimuth.sin_cos();
        let outward = Vector3::new(cos_e * sin_a, -cos_e * cos_a, sin_e);
        let forward = -outward;
        let right = Vector3::new(cos_a, sin_a, 0.0);
        let down = forward.cross(&right);
        let rotation =
            Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[right, down, forward]));
        let position = Vector3::from(self.look_at_m) + outward * self.distance_m;
        RigidTransform::from_parts(
            Translation3::from(position),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn camera_looks_at_its_target_with_a_level_horizon() {
        for azimuth_deg in [0.0, 35.0, 200.0] {
            let mount = CameraMount {
                azimuth_deg,
                ..CameraMount::default()
            };
            let camera_from_world = mount.world_from_camera(0.0).inverse();
            let target = camera_from_world * Point3::from(mount.look_at_m);
            assert!((target - Point3::new(0.0, 0.0, mount.distance_m)).norm() < 1e-12);
            let up = camera_from_world * Vector3::z();
            assert!(up.x.abs() < 1e-12 && up.y < 0.0, "{up}");
        }
    }

    #[test]
    fn orbit_rotates_the_camera() {
        let mount = CameraMount {
            orbit_deg_s: 10.0,
            ..CameraMount::default()
        };
        let around = |time_s: f64| {
            let seen =
                mount.world_from_camera(time_s).translation.vector - Vector3::from(mount.look_at_m);
            seen.y.atan2(seen.x).to_degrees()
        };
        assert!((around(3.0) - around(0.0) - 30.0).abs() < 1e-9);
    }
}
