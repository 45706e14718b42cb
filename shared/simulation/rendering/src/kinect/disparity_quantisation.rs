//! Depth comes in steps, since disparity is found in fractions of a pixel.

use super::sensor_model::check;
use crate::Error;

/// Steps of the disparity.
///
/// With focal length f and baseline b, depth is z = f·b/d, and a step of d
/// changes z by z²·step/(f·b): 2.85 mm at 1 m, 45 mm at 4 m (Khoshelham and
/// Elberink 2012, equation 9 and figure 7).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisparityQuantisation {
    /// Smallest difference of disparity, pixels; 0.001 to 4.
    pub step_px: f32,
}

impl DisparityQuantisation {
    /// An eighth of a pixel.
    pub const KINECT_V1: Self = Self { step_px: 0.125 };

    pub(super) fn check(&self) -> Result<(), Error> {
        check("quantisation.step_px", self.step_px, 1e-3, 4.0)
    }

    /// Difference of depth between two neighbouring values at `z_m`, metres.
    /// `focal_baseline` is the focal length in pixels times the baseline in metres.
    #[inline]
    pub(super) fn depth_step_m(&self, z_m: f32, focal_baseline: f32) -> f32 {
        z_m * z_m * (self.step_px / focal_baseline)
    }

    /// The nearest allowed disparity, pixels.
    #[inline]
    pub(super) fn quantise(&self, disparity_px: f32) -> f32 {
        round(disparity_px / self.step_px) * self.step_px
    }
}

/// The nearest whole number, for less than 2²² of either sign.
///
/// Adding 1.5·2²³ leaves no bits for a fraction. Unlike `f32::round` it needs no
/// call where the processor has no instruction for it, and can be vectorised.
#[inline]
pub(super) fn round(x: f32) -> f32 {
    const NO_FRACTION: f32 = 12_582_912.0;
    (x + NO_FRACTION) - NO_FRACTION
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_agree_with_the_publication() {
        let step_m = |z: f32| DisparityQuantisation::KINECT_V1.depth_step_m(z, 585.0 * 0.075);
        assert!((step_m(1.0) - 2.85e-3).abs() < 2e-5);
        assert!((step_m(4.0) - 45.6e-3).abs() < 5e-4);
    }

    #[test]
    fn rounding_is_to_the_nearest() {
        for x in [0.0, 0.4, 0.6, 1.49, 87.51, -3.7, 100_000.3] {
            assert_eq!(round(x), x.round());
        }
    }
}
