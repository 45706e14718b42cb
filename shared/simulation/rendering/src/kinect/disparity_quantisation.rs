//! Disparity quantisation, which makes depth discrete.

use crate::rounding::round;
use value_range::{OutOfRange, check_range};

/// Quantisation step of the disparity.
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
    /// Step of an eighth of a pixel (Khoshelham and Elberink 2012).
    pub const KINECT_V1: Self = Self { step_px: 0.125 };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("quantisation.step_px", self.step_px, 1e-3, 4.0)
    }

    /// Depth quantisation step at depth `z_m`, metres. `focal_baseline` is the focal length in
    /// pixels times the baseline in metres.
    #[inline]
    pub(super) fn depth_step_m(&self, z_m: f32, focal_baseline: f32) -> f32 {
        z_m * z_m * (self.step_px / focal_baseline)
    }

    /// Rounds to the nearest disparity level, pixels.
    #[inline]
    pub(super) fn quantise(&self, disparity_px: f32) -> f32 {
        round(disparity_px / self.step_px) * self.step_px
    }
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
}
