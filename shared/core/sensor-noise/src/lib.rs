//! The depth noise of a structured-light camera.

/// Standard deviation of a Kinect v1 depth reading at depth `z_m`, metres
/// (Nguyen, Izadi and Lovell 2012, axial part for surfaces facing the camera).
///
/// Depths below 0.4 m have the noise at 0.4 m; a depth that is not finite has
/// the noise at 10 m, so that the result is always positive and finite.
#[inline]
pub fn kinect_depth_sigma_m(z_m: f64) -> f64 {
    let beyond_m = if z_m.is_finite() {
        (z_m - 0.4).clamp(0.0, 9.6)
    } else {
        9.6
    };
    0.0012 + 0.0019 * beyond_m * beyond_m
}

/// [`kinect_depth_sigma_m`] for a depth known to be in the sensor's range.
#[inline]
pub fn depth_sigma_m(z_m: f32) -> f32 {
    let beyond_m = (z_m - 0.4).max(0.0);
    0.0012 + 0.0019 * beyond_m * beyond_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_grows_with_depth_and_is_always_usable() {
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
