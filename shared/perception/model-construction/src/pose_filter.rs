//! Kalman filter of the camera's pose: the robot's own poses, a smooth motion, and registrations.

use nalgebra::{Isometry3, Matrix3, Matrix6, Point3, SMatrix, SVector};
use registration::Prior;
use registration::twist::{Twist, exponential, isotropic, moved_to, twist_at};

/// Standard deviation of the acceleration of a camera that a person or a robot moves, of the
/// rotation, rad/s², and of the translation, m/s². Chosen.
const ACCELERATION_SIGMA: [f64; 2] = [0.5, 0.4];

/// Standard deviation of the velocity of a camera at first. Chosen: rad/s and m/s.
const VELOCITY_SIGMA: [f64; 2] = [0.5, 0.4];

/// Standard deviation of a registration of a view with little noise, about the centre of the
/// object. Chosen: it is often better, and sometimes off.
const REGISTRATION_SIGMA: PoseSigma = PoseSigma {
    rotation_rad: 0.015,
    translation_m: 0.003,
};

/// Noise of a view from which on a registration is less sure, metres: that of a Kinect at 0.8 m.
const REGISTRATION_NOISE_M: f64 = 0.0015;

/// Longest time over which a motion is continued, seconds. Chosen.
const TIME_STEP_MAX_S: f64 = 2.0;

type Matrix12 = SMatrix<f64, 12, 12>;

/// Standard deviation of a pose about and along each axis: of a reported camera pose in the axes of
/// the camera, and of a registration about the centre of the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseSigma {
    /// Of the rotation about each axis, radians.
    pub rotation_rad: f64,
    /// Of the place along each axis, metres.
    pub translation_m: f64,
}

impl PoseSigma {
    /// Standard deviation of the registration of a view with a noise, metres, in proportion to it.
    pub(crate) fn of_registration(noise_m: f64) -> Self {
        let share = (noise_m / REGISTRATION_NOISE_M).max(1.0);
        Self {
            rotation_rad: share * REGISTRATION_SIGMA.rotation_rad,
            translation_m: share * REGISTRATION_SIGMA.translation_m,
        }
    }

    /// Covariance of a twist.
    pub(crate) fn covariance(&self) -> Matrix6<f64> {
        isotropic(self.rotation_rad.max(1e-6), self.translation_m.max(1e-6))
    }
}

/// Error-state Kalman filter of a pose with constant velocity. Errors are twists in the frame of
/// the camera, about its centre.
#[derive(Debug, Clone)]
pub(crate) struct PoseFilter {
    object_from_camera: Isometry3<f64>,
    /// Twist a second, in the frame of the camera.
    velocity: Twist,
    covariance: Matrix12,
    time_ns: u64,
}

impl PoseFilter {
    /// Filter that starts with a reported pose.
    pub(crate) fn new(object_from_camera: Isometry3<f64>, sigma: &PoseSigma, time_ns: u64) -> Self {
        let mut covariance = Matrix12::zeros();
        covariance
            .fixed_view_mut::<6, 6>(0, 0)
            .copy_from(&sigma.covariance());
        let velocity = isotropic(VELOCITY_SIGMA[0], VELOCITY_SIGMA[1]);
        covariance.fixed_view_mut::<6, 6>(6, 6).copy_from(&velocity);
        Self {
            object_from_camera,
            velocity: Twist::zeros(),
            covariance,
            time_ns,
        }
    }

    /// Continues the motion to a time.
    pub(crate) fn predict(&mut self, time_ns: u64) {
        let step_s = (time_ns.saturating_sub(self.time_ns) as f64 * 1e-9).min(TIME_STEP_MAX_S);
        self.time_ns = self.time_ns.max(time_ns);
        self.object_from_camera *= exponential(&(self.velocity * step_s));
        let mut transition = Matrix12::identity();
        transition
            .fixed_view_mut::<6, 6>(0, 6)
            .copy_from(&(Matrix6::identity() * step_s));
        let noise = isotropic(ACCELERATION_SIGMA[0], ACCELERATION_SIGMA[1]);
        let mut process = Matrix12::zeros();
        let parts = [
            (0, 0, 4, 4.0),
            (0, 6, 3, 2.0),
            (6, 0, 3, 2.0),
            (6, 6, 2, 1.0),
        ];
        for (row, column, power, divisor) in parts {
            process
                .fixed_view_mut::<6, 6>(row, column)
                .copy_from(&(noise * (step_s.powi(power) / divisor)));
        }
        self.covariance = transition * self.covariance * transition.transpose() + process;
    }

    /// Updates by a pose that the robot reports.
    pub(crate) fn observe(&mut self, object_from_camera: &Isometry3<f64>, sigma: &PoseSigma) {
        self.update(object_from_camera, &sigma.covariance());
    }

    /// Updates by a registration of the object, whose centre is given in the frame of the camera.
    pub(crate) fn register(
        &mut self,
        object_from_camera: &Isometry3<f64>,
        centre: &Point3<f64>,
        sigma: &PoseSigma,
    ) {
        // From the centre of the object back to that of the camera.
        let back = moved_to(&Point3::from(-centre.coords));
        let about_camera = back * sigma.covariance() * back.transpose();
        self.update(object_from_camera, &about_camera);
    }

    /// Updates by the place at which the camera sees the object: a point in the frame of the
    /// camera, its place in the frame of the object, and its standard deviation along each axis,
    /// metres.
    pub(crate) fn see(&mut self, seen: &Point3<f64>, place: &Point3<f64>, sigma_m: f64) {
        let expected = self.object_from_camera.inverse() * place;
        // Motion of the point under a twist of the camera: the lower half of the moved twist.
        let moved = moved_to(seen).fixed_rows::<3>(3).into_owned();
        let noise = Matrix3::from_diagonal_element(sigma_m.powi(2));
        self.correct(&moved, &(expected - seen), &noise);
    }

    fn update(&mut self, measured: &Isometry3<f64>, noise: &Matrix6<f64>) {
        let off = self.object_from_camera.inverse() * measured;
        let innovation = twist_at(&off, &Point3::origin());
        self.correct(&Matrix6::identity(), &innovation, noise);
    }

    /// Correction by a measurement of `N` values that are linear in the twist of the pose.
    fn correct<const N: usize>(
        &mut self,
        model: &SMatrix<f64, N, 6>,
        innovation: &SVector<f64, N>,
        noise: &SMatrix<f64, N, N>,
    ) {
        let rows = model * self.covariance.fixed_view::<6, 12>(0, 0);
        let total = rows.fixed_columns::<6>(0) * model.transpose() + noise;
        let Some(inverse) = total.try_inverse() else {
            return;
        };
        let gain = rows.transpose() * inverse;
        let change = gain * innovation;
        self.object_from_camera *= exponential(&change.fixed_rows::<6>(0).into_owned());
        self.velocity += change.fixed_rows::<6>(6);
        self.covariance -= gain * rows;
        self.covariance = 0.5 * (self.covariance + self.covariance.transpose());
    }

    /// Place of the camera in the frame of the object.
    pub(crate) fn camera_place(&self) -> Point3<f64> {
        Point3::from(self.object_from_camera.translation.vector)
    }

    /// Prior of a registration of a surface with its centre, in the frame of the camera.
    pub(crate) fn prior(&self, centre: &Point3<f64>) -> Prior {
        let to_centre = moved_to(centre);
        let pose = self.covariance.fixed_view::<6, 6>(0, 0);
        let covariance = to_centre * pose * to_centre.transpose();
        let sigma = |first: usize| {
            let trace: f64 = (first..first + 3).map(|i| covariance[(i, i)]).sum();
            (trace / 3.0).max(0.0).sqrt()
        };
        Prior {
            target_from_source: self.object_from_camera,
            translation_sigma_m: sigma(3),
            rotation_sigma_rad: sigma(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registration_is_less_sure_with_more_noise() {
        let sigma = PoseSigma::of_registration;
        assert_eq!(sigma(0.0005), sigma(REGISTRATION_NOISE_M));
        let far = sigma(3.0 * REGISTRATION_NOISE_M);
        assert!((far.rotation_rad / sigma(0.0).rotation_rad - 3.0).abs() < 1e-9);
        assert!((far.translation_m / sigma(0.0).translation_m - 3.0).abs() < 1e-9);
    }
}
