//! Noise settings of the motion filter.

use crate::Error;
use value_range::check_ranges;

/// Process and measurement noise of the motion filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionConfig {
    /// Standard deviation of the acceleration of a handled object, m/s²; 0.01 to 100.
    pub acceleration_sigma_m_s2: f64,
    /// Standard deviation of the acceleration of an untouched object, m/s²; 0.001 to
    /// 100. A larger innovation switches to the handled-motion model.
    pub resting_acceleration_sigma_m_s2: f64,
    /// Standard deviation of the angular acceleration of a handled object, rad/s²; 0.01
    /// to 1000. An untouched object has a fiftieth of it.
    pub angular_acceleration_sigma_rad_s2: f64,
    /// Random walk of a half side, metres per square root of a second; 0.00001 to 0.1.
    pub size_random_walk_sigma_m: f64,
    /// Lower limit of the standard deviation of a measured box face, metres; 0.0001 to
    /// 0.1.
    pub face_sigma_min_m: f64,
    /// Lower limit of the standard deviation of a measured box centre in data
    /// association, metres; 0.0001 to 0.1. The default covers the shift of the box when
    /// a handle is detected in one frame and missed in the next.
    pub position_sigma_min_m: f64,
}

impl Default for MotionConfig {
    /// Default noise levels. Chosen.
    fn default() -> Self {
        Self {
            acceleration_sigma_m_s2: 1.5,
            resting_acceleration_sigma_m_s2: 0.1,
            angular_acceleration_sigma_rad_s2: 15.0,
            size_random_walk_sigma_m: 0.002,
            face_sigma_min_m: 0.002,
            position_sigma_min_m: 0.008,
        }
    }
}

impl MotionConfig {
    /// Validates the motion settings against their ranges.
    ///
    /// # Errors
    /// Names the first setting outside its range.
    pub fn validated(self) -> Result<Self, Error> {
        check_ranges(&[
            (
                "acceleration_sigma_m_s2",
                self.acceleration_sigma_m_s2,
                0.01,
                100.0,
            ),
            (
                "resting_acceleration_sigma_m_s2",
                self.resting_acceleration_sigma_m_s2,
                1e-3,
                100.0,
            ),
            (
                "angular_acceleration_sigma_rad_s2",
                self.angular_acceleration_sigma_rad_s2,
                0.01,
                1000.0,
            ),
            (
                "size_random_walk_sigma_m",
                self.size_random_walk_sigma_m,
                1e-5,
                0.1,
            ),
            ("face_sigma_min_m", self.face_sigma_min_m, 1e-4, 0.1),
            ("position_sigma_min_m", self.position_sigma_min_m, 1e-4, 0.1),
        ])?;
        Ok(self)
    }
}
