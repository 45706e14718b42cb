//! Lateral noise of depth borders (Nguyen, Izadi and Lovell 2012).

use std::f32::consts::FRAC_PI_2;
use value_range::{OutOfRange, check_range};

/// Lateral noise: standard deviation of the position of a depth border at the angle of incidence
/// θ,
///
/// σ(θ) = 0.8 + 0.035 θ/(π/2 − θ) pixels
///
/// (Nguyen, Izadi and Lovell 2012, equation 4). It moves borders only: inside an
/// inclined surface the published axial noise already contains its effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralNoise {
    /// Factor on the published noise law; 0 to 4.
    pub strength: f32,
}

impl LateralNoise {
    /// Published lateral noise of the Kinect v1 (strength 1).
    pub const KINECT_V1: Self = Self { strength: 1.0 };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("lateral_noise.strength", self.strength, 0.0, 4.0)
    }

    /// Standard deviation of a border by the angle of incidence, radians, in pixels.
    pub fn sigma_px(&self, angle_rad: f32) -> f32 {
        let angle_rad = angle_rad.clamp(0.0, 1.45);
        self.strength * (0.8 + 0.035 * angle_rad / (FRAC_PI_2 - angle_rad))
    }

    /// Lookup table of [`Self::sigma_px`] by cosine times 255.
    pub(super) fn sigmas_px(&self) -> [f32; 256] {
        std::array::from_fn(|cosine| self.sigma_px((cosine as f32 / 255.0).acos()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_has_its_published_values() {
        let noise = LateralNoise::KINECT_V1;
        assert_eq!(noise.sigma_px(0.0), 0.8);
        assert!((noise.sigma_px(std::f32::consts::FRAC_PI_4) - 0.835).abs() < 1e-6);
    }
}
