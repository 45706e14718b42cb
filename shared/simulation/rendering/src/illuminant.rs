//! Black-body light: colour temperature and intensity.

/// Black-body illuminant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illuminant {
    /// Colour temperature, kelvin: 2700 for a warm bulb, 4000 for an office, 6500 for daylight.
    /// Clamped to 1000 to 15 000 K.
    pub temperature_k: f32,
    /// Illuminance relative to that of a well exposed image; negative values count as 0.
    pub intensity: f32,
}

impl Illuminant {
    /// Illuminant without light.
    pub const DARK: Self = Self {
        temperature_k: 6500.0,
        intensity: 0.0,
    };

    /// Linear sRGB components; their luminance is the intensity.
    ///
    /// Chromaticity by Krystek's rational approximation of the Planckian locus
    /// (1985), then CIE 1931 to linear sRGB (IEC 61966-2-1). Components outside
    /// the gamut are 0.
    pub fn linear_rgb(&self) -> [f32; 3] {
        let intensity = if self.intensity.is_finite() {
            self.intensity.max(0.0)
        } else {
            0.0
        };
        black_body_rgb(self.temperature_k).map(|channel| channel * intensity)
    }
}

/// Linear sRGB of a black body with luminance 1.
pub(crate) fn black_body_rgb(temperature_k: f32) -> [f32; 3] {
    let t = if temperature_k.is_nan() {
        6500.0
    } else {
        f64::from(temperature_k).clamp(1000.0, 15_000.0)
    };
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    let scale = 1.0 / (2.0 * u - 8.0 * v + 4.0);
    let (x, y) = (3.0 * u * scale, 2.0 * v * scale);
    let (cx, cz) = (x / y, (1.0 - x - y) / y);
    let rgb = [
        3.240_625 * cx - 1.537_208 - 0.498_629 * cz,
        -0.968_931 * cx + 1.875_756 + 0.041_518 * cz,
        0.055_710 * cx - 0.204_021 + 1.056_996 * cz,
    ];
    rgb.map(|channel| channel.max(0.0) as f32)
}

/// Luminance of a linear sRGB colour (Rec. 709 weights).
#[inline]
pub(crate) fn luminance(rgb: [f32; 3]) -> f32 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn daylight_is_nearly_white_and_a_bulb_is_orange() {
        let [r, g, b] = black_body_rgb(6500.0);
        assert!(
            (r - 1.0).abs() < 0.05 && (g - 1.0).abs() < 0.05 && (b - 1.0).abs() < 0.05,
            "{r} {g} {b}"
        );
        let [r, g, b] = black_body_rgb(2700.0);
        assert!(r > 1.3 * g && g > 1.5 * b, "{r} {g} {b}");
        let [r, _, b] = black_body_rgb(10_000.0);
        assert!(b > r);
    }

    #[test]
    fn the_luminance_is_the_intensity() {
        for temperature_k in [2700.0, 4000.0, 6500.0, 9000.0] {
            let light = Illuminant {
                temperature_k,
                intensity: 0.7,
            };
            assert!((luminance(light.linear_rgb()) - 0.7).abs() < 0.01);
        }
        let broken = Illuminant {
            temperature_k: f32::NAN,
            intensity: f32::NAN,
        };
        assert_eq!(broken.linear_rgb(), [0.0; 3]);
    }
}
