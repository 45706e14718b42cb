//! Missing depth: range limits, border speckle and weak infrared signal.

use value_range::{OutOfRange, check_range};

/// Depth range of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthRange {
    /// Least measurable depth, metres; 0 to 10.
    pub min_m: f32,
    /// Greatest measurable depth, metres; `min_m` to 20.
    pub max_m: f32,
}

impl DepthRange {
    /// Range between overexposure and too weak a pattern. Chosen.
    pub const KINECT_V1: Self = Self {
        min_m: 0.45,
        max_m: 4.5,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("range.min_m", self.min_m, 0.0, 10.0)?;
        check_range("range.max_m", self.max_m, self.min_m, 20.0)
    }
}

/// Border speckle: holes at depth discontinuities, since the matching window sees two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BorderSpeckle {
    /// Share of border pixels without depth; 0 to 1.
    pub missing_share: f32,
}

impl BorderSpeckle {
    /// Border speckle of the Kinect v1, estimated from pictures of real cameras.
    pub const KINECT_V1: Self = Self {
        missing_share: 0.25,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("border_speckle.missing_share", self.missing_share, 0.0, 1.0)
    }
}

/// Signal loss: no depth where too little of the projected infrared pattern returns.
///
/// Three independent causes. *Faint*: the returned light per solid angle is infrared albedo · cos
/// θ / z², and below a level dots are lost. *Grazing*: at a small cosine the pattern is stretched
/// beyond the matching window. *Mirror*: a polished surface reflects the dots away from the
/// camera, the more so the farther and the more inclined it is; head-on it blinds the camera. The
/// levels are estimates: no published measurement covers them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeakSignal {
    /// Returned light at which every dot is lost, relative to a white surface at 1 m; 0 to 1.
    pub none_below: f32,
    /// Returned light from which no dot is lost; `none_below` to 1.
    pub all_above: f32,
    /// Cosine of incidence at which every dot is lost; 0 to 1.
    pub grazing_none_cos: f32,
    /// Cosine of incidence from which no dot is lost; `grazing_none_cos` to 1.
    pub grazing_all_cos: f32,
    /// Factor on the probability of signal loss at mirror-like surfaces; 0 to 4.
    pub mirror: f32,
}

impl WeakSignal {
    /// Weak signal of the Kinect v1, estimated from pictures of real cameras.
    pub const KINECT_V1: Self = Self {
        none_below: 0.006,
        all_above: 0.030,
        grazing_none_cos: 0.06,
        grazing_all_cos: 0.26,
        mirror: 1.0,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("weak_signal.none_below", self.none_below, 0.0, 1.0)?;
        check_range(
            "weak_signal.all_above",
            self.all_above,
            self.none_below,
            1.0,
        )?;
        check_range(
            "weak_signal.grazing_none_cos",
            self.grazing_none_cos,
            0.0,
            1.0,
        )?;
        check_range(
            "weak_signal.grazing_all_cos",
            self.grazing_all_cos,
            self.grazing_none_cos,
            1.0,
        )?;
        check_range("weak_signal.mirror", self.mirror, 0.0, 4.0)
    }

    /// Probability of a missing depth value, 0 to 1. The cosine, the infrared albedo and the
    /// specular share are between 0 and 1.
    #[inline]
    pub(super) fn missing_share(
        &self,
        z_m: f32,
        cos_incidence: f32,
        infrared: f32,
        specular: f32,
    ) -> f32 {
        let returned = infrared * cos_incidence;
        let z2 = z_m * z_m;
        let faint = ramp(returned, self.none_below * z2, self.all_above * z2);
        let grazing = ramp(cos_incidence, self.grazing_none_cos, self.grazing_all_cos);
        let inclined = 1.0 - cos_incidence;
        let blinding = (cos_incidence * 50.0 - 49.0).max(0.0);
        let mirrored = self.mirror
            * specular
            * specular
            * (0.15 + 0.6 * inclined + 0.12 * z_m + 0.5 * blinding);
        1.0 - faint * grazing * (1.0 - mirrored.min(1.0))
    }
}

/// Linear ramp: 0 below `none`, 1 from `all` on.
#[inline]
fn ramp(value: f32, none: f32, all: f32) -> f32 {
    const STEEPEST: f32 = 1e-9;
    ((value - none + STEEPEST) / (all - none + STEEPEST)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_share_increases_with_angle_distance_polish_and_blackness() {
        let chance = |z: f32, cos: f32, infrared: f32, specular: f32| {
            WeakSignal::KINECT_V1.missing_share(z, cos, infrared, specular)
        };
        assert_eq!(chance(1.0, 1.0, 0.7, 0.0), 0.0);
        for cosines in [0.5, 0.25, 0.2, 0.1, 0.05].windows(2) {
            assert!(chance(1.0, cosines[0], 0.7, 0.0) < chance(1.0, cosines[1], 0.7, 0.0));
        }
        for distances in [1.5, 2.0, 3.0].windows(2) {
            assert!(chance(distances[0], 0.9, 0.04, 0.0) < chance(distances[1], 0.9, 0.04, 0.0));
            assert!(chance(distances[0], 0.9, 0.7, 0.5) < chance(distances[1], 0.9, 0.7, 0.5));
        }
        assert!(chance(1.0, 0.9, 0.7, 0.3) < chance(1.0, 0.9, 0.7, 0.9));
        assert!(chance(1.0, 0.0, 0.7, 0.0) > 0.999_999);
    }
}
