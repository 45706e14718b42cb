//! Axial depth noise (Nguyen, Izadi and Lovell 2012).

use super::DisparityQuantisation;
use std::f32::consts::FRAC_PI_2;
use value_range::{OutOfRange, check_range};

/// Greatest angle of incidence for which the noise is computed, radians. The published law grows
/// without limit towards a right angle.
const ANGLE_MAX_RAD: f32 = 1.45;

/// Axial noise: standard deviation of depth by distance z and angle of incidence θ,
///
/// σ(z, θ) = 0.0012 + 0.0019 (z − 0.4)² + 0.0001/√z · θ²/(π/2 − θ)² metres
///
/// (Nguyen, Izadi and Lovell 2012, equation 5; measured from 0.5 to 3 m and 0 to 70°). It was
/// measured on quantised depth; the added noise therefore has the variance σ² − step²/12.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialNoise {
    /// Factor on the published law; 0 to 10.
    pub strength: f32,
    /// Share of the variance that neighbouring pixels have in common, since their matching
    /// windows overlap; 0 to 1. Chosen.
    pub common_share: f32,
}

impl AxialNoise {
    /// Published axial noise of the Kinect v1 (strength 1).
    pub const KINECT_V1: Self = Self {
        strength: 1.0,
        common_share: 0.4,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("axial_noise.strength", self.strength, 0.0, 10.0)?;
        check_range("axial_noise.common_share", self.common_share, 0.0, 1.0)
    }

    /// Published standard deviation, metres, times the strength.
    ///
    /// `z_m` below 0.4 counts as 0.4, an angle above 1.45 rad as 1.45 rad.
    pub fn sigma_m(&self, z_m: f32, angle_rad: f32) -> f32 {
        self.strength * sigma_m(z_m, angle_term(angle_rad))
    }

    /// Standard deviation of the noise added before quantisation, metres.
    #[inline]
    pub(super) fn random_sigma_m(&self, z_m: f32, angle_term: f32, step_m: f32) -> f32 {
        let sigma_m = self.strength * sigma_m(z_m, angle_term);
        (sigma_m * sigma_m - step_m * step_m * (1.0 / 12.0))
            .max(0.0)
            .sqrt()
    }
}

/// Published standard deviation for strength 1, metres, from a precomputed angle term.
#[inline]
fn sigma_m(z_m: f32, angle_term: f32) -> f32 {
    let z_m = z_m.max(0.4);
    let beyond_m = z_m - 0.4;
    0.0012 + 0.0019 * beyond_m * beyond_m + angle_term / z_m.sqrt()
}

/// Angle term of the published law: 0.0001 · θ²/(π/2 − θ)².
fn angle_term(angle_rad: f32) -> f32 {
    let angle_rad = angle_rad.clamp(0.0, ANGLE_MAX_RAD);
    let ratio = angle_rad / (FRAC_PI_2 - angle_rad);
    0.0001 * ratio * ratio
}

/// Lookup table of [`angle_term`] by cosine times 255.
pub(super) fn angle_terms() -> [f32; 256] {
    std::array::from_fn(|cosine| angle_term((cosine as f32 / 255.0).acos()))
}

/// Depth quantisation step, metres; 0 without quantisation.
#[inline]
pub(super) fn step_m(
    quantisation: Option<&DisparityQuantisation>,
    z_m: f32,
    focal_baseline: f32,
) -> f32 {
    quantisation.map_or(0.0, |q| q.depth_step_m(z_m, focal_baseline))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_has_its_published_values() {
        let noise = AxialNoise::KINECT_V1;
        assert!((noise.sigma_m(0.4, 0.0) - 0.0012).abs() < 1e-7);
        assert!((noise.sigma_m(1.4, 0.0) - 0.0031).abs() < 1e-6);
        // At 45° the angle term is 0.0001/√z.
        let slanted = noise.sigma_m(1.0, std::f32::consts::FRAC_PI_4);
        assert!((slanted - noise.sigma_m(1.0, 0.0) - 0.0001).abs() < 1e-7);
        assert!(noise.sigma_m(1.0, 10.0).is_finite());
    }
}
