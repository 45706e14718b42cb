//! Depth noise model of a structured-light camera: standard deviation as a function of
//! range.
//!
//! # Example
//!
//! ```
//! use sensor_noise::kinect_depth_sigma_m;
//!
//! assert!(kinect_depth_sigma_m(0.8) < 0.002);
//! assert!(kinect_depth_sigma_m(2.0) > 0.005);
//! ```

/// Axial depth noise of a Kinect v1: standard deviation of a reading at depth `z_m`, metres
/// (Nguyen, Izadi and Lovell 2012, surfaces facing the camera).
///
/// Below 0.4 m the value at 0.4 m applies; a depth that is not finite has the value at 10
/// m. The result is always positive and finite.
#[inline]
pub fn kinect_depth_sigma_m(z_m: f64) -> f64 {
    let beyond_m = if z_m.is_finite() {
        (z_m - 0.4).clamp(0.0, 9.6)
    } else {
        9.6
    };
    0.0012 + 0.0019 * beyond_m * beyond_m
}

/// Axial depth noise of a Kinect v1 in single precision, metres: [`kinect_depth_sigma_m`]
/// for a depth that is known to be finite and in range.
#[inline]
pub fn depth_sigma_m(z_m: f32) -> f32 {
    let beyond_m = (z_m - 0.4).max(0.0);
    0.0012 + 0.0019 * beyond_m * beyond_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_grows_with_depth_and_stays_finite() {
        let depths = [0.0, 0.4, 0.5, 1.0, 2.0, 5.0, 1e300];
        for pair in depths.windows(2) {
            assert!(kinect_depth_sigma_m(pair[0]) <= kinect_depth_sigma_m(pair[1]));
        }
        for z in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -3.0] {
            assert!(kinect_depth_sigma_m(z) > 0.0 && kinect_depth_sigma_m(z) < 1.0);
        }
        for z in [0.35_f32, 1.0, 2.0] {
            assert!(
                (kinect_depth_sigma_m(f64::from(z)) - f64::from(depth_sigma_m(z))).abs() < 1e-8
            );
        }
    }
}
