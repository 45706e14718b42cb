//! Expected pose of a view.

use nalgebra::Isometry3;

/// Expected pose of the source in the frame of the target, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Expected pose.
    pub target_from_source: Isometry3<f64>,
    /// Standard deviation of the place of the source's centre along each axis, metres.
    pub translation_sigma_m: f64,
    /// Standard deviation of the rotation about each axis, radians.
    pub rotation_sigma_rad: f64,
}

impl Prior {
    /// Prior of a hand-guided or unknown motion: 3 cm and 10°.
    pub fn at(target_from_source: Isometry3<f64>) -> Self {
        Self {
            target_from_source,
            translation_sigma_m: 0.03,
            rotation_sigma_rad: 10.0_f64.to_radians(),
        }
    }

    /// This prior with standard deviations that can be divided by.
    pub(crate) fn with_positive_sigmas(&self) -> Self {
        Self {
            target_from_source: self.target_from_source,
            translation_sigma_m: self.translation_sigma_m.max(1e-6),
            rotation_sigma_rad: self.rotation_sigma_rad.max(1e-6),
        }
    }
}
