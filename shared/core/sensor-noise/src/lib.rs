//! Depth noise laws of range cameras: standard deviation as a function of depth.
//!
//! # Example
//!
//! ```
//! use sensor_noise::DepthNoise;
//!
//! let noise = DepthNoise::KINECT_V1;
//! assert!(noise.sigma_m(0.8) < 0.002);
//! assert!(noise.sigma_m(2.0) > 0.005);
//! assert_eq!(noise.scaled(2.0).sigma_m(1.0), 2.0 * noise.sigma_m(1.0));
//! ```

/// Axial depth noise law: the standard deviation of a reading grows with the square of its
/// depth beyond an onset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthNoise {
    /// Standard deviation up to the onset, metres.
    pub floor_m: f32,
    /// Growth with the squared depth beyond the onset, 1/metre.
    pub per_m: f32,
    /// Depth from which the noise grows, metres.
    pub onset_m: f32,
}

/// Greatest depth of the laws, metres; a depth that is not finite has the noise of this one.
const DEPTH_MAX_M: f32 = 10.0;

impl DepthNoise {
    /// Noise law of a Kinect v1 with structured light (Nguyen, Izadi and Lovell 2012, surfaces
    /// facing the camera).
    pub const KINECT_V1: Self = Self {
        floor_m: 0.0012,
        per_m: 0.0019,
        onset_m: 0.4,
    };

    /// Noise law of an active stereo camera with a baseline of 5 cm and a disparity noise of
    /// 0.08 pixels, as those of the `RealSense` D400 series: z² · 0.08 / (640 px · 0.05 m).
    pub const STEREO: Self = Self {
        floor_m: 0.0008,
        per_m: 0.0025,
        onset_m: 0.0,
    };

    /// Noise law of a time-of-flight camera, as a Kinect v2 or Azure Kinect: it hardly depends
    /// on the depth within reach of a table.
    pub const TIME_OF_FLIGHT: Self = Self {
        floor_m: 0.0015,
        per_m: 0.0003,
        onset_m: 0.5,
    };

    /// Names of the laws, as in the configuration.
    pub const NAMES: [&str; 3] = ["kinect-v1", "stereo", "time-of-flight"];

    /// Law of a name of [`NAMES`](Self::NAMES); `None` for another name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "kinect-v1" => Some(Self::KINECT_V1),
            "stereo" => Some(Self::STEREO),
            "time-of-flight" => Some(Self::TIME_OF_FLIGHT),
            _ => None,
        }
    }

    /// Name of the law in the configuration; `None` for a law that has none.
    pub fn name(&self) -> Option<&'static str> {
        Self::NAMES
            .into_iter()
            .find(|name| Self::named(name) == Some(*self))
    }

    /// Law with `factor` times the standard deviation.
    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        Self {
            floor_m: factor * self.floor_m,
            per_m: factor * self.per_m,
            onset_m: self.onset_m,
        }
    }

    /// Standard deviation of a reading, metres, at a depth that is finite and in range.
    #[inline]
    pub fn sigma_m(&self, z_m: f32) -> f32 {
        let beyond_m = (z_m - self.onset_m).max(0.0);
        self.floor_m + self.per_m * beyond_m * beyond_m
    }

    /// Standard deviation of a reading in double precision, metres; positive and finite for
    /// any depth. One that is not finite, or is beyond 10 m, has the noise at 10 m.
    #[inline]
    pub fn bounded_sigma_m(&self, z_m: f64) -> f64 {
        let z_m = if z_m.is_finite() {
            z_m.clamp(0.0, f64::from(DEPTH_MAX_M))
        } else {
            f64::from(DEPTH_MAX_M)
        };
        let beyond_m = (z_m - f64::from(self.onset_m)).max(0.0);
        f64::from(self.floor_m) + f64::from(self.per_m) * beyond_m * beyond_m
    }
}

impl Default for DepthNoise {
    fn default() -> Self {
        Self::KINECT_V1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> impl Iterator<Item = DepthNoise> {
        DepthNoise::NAMES.into_iter().filter_map(DepthNoise::named)
    }

    #[test]
    fn noise_grows_with_depth_and_stays_finite() {
        assert_eq!(laws().count(), DepthNoise::NAMES.len());
        let depths = [0.0, 0.4, 0.5, 1.0, 2.0, 5.0, 1e300];
        for noise in laws() {
            for pair in depths.windows(2) {
                assert!(noise.bounded_sigma_m(pair[0]) <= noise.bounded_sigma_m(pair[1]));
            }
            for z in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -3.0] {
                assert!(noise.bounded_sigma_m(z) > 0.0 && noise.bounded_sigma_m(z) < 1.0);
            }
            for z in [0.35_f32, 1.0, 2.0] {
                let difference = noise.bounded_sigma_m(f64::from(z)) - f64::from(noise.sigma_m(z));
                assert!(difference.abs() < 1e-8);
            }
        }
    }

    #[test]
    fn an_unknown_name_has_no_law() {
        assert_eq!(DepthNoise::named("kinect"), None);
    }

    #[test]
    fn a_law_knows_its_name() {
        for name in DepthNoise::NAMES {
            assert_eq!(
                DepthNoise::named(name).and_then(|law| law.name()),
                Some(name)
            );
        }
        assert_eq!(DepthNoise::KINECT_V1.scaled(2.0).name(), None);
    }
}
