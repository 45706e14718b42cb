//! White balance: the colour of a scene's light by the grey-world assumption, and the gains that
//! make it neutral.

use point_cloud::{Point, Rgba};

/// Number of pixels, approximately, from which the light of a frame is estimated. Chosen: the
/// error of their mean is far below the tolerance.
const N_SAMPLES: usize = 5000;

/// Least number of unsaturated samples for an estimate. Chosen.
const N_SAMPLES_MIN: usize = 200;

/// Value of a channel above which a pixel is saturated, and has lost its colour. Chosen.
const SATURATED: u8 = 250;

/// Distance of the mean of a scene from grey, in logarithms of encoded ratios, that its own
/// colours, such as those of a wooden table, explain. Chosen: objects under seven lightings on
/// four tables; with 0.15 and 0.25 the worst accuracy was 1.7 and 0.3 points lower.
const SCENE_TOLERANCE: f32 = 0.2;

/// Limits of a gain.
const GAIN_MIN: f32 = 0.25;
const GAIN_MAX: f32 = 4.0;

/// Colour of the light of a scene: natural logarithms of red and of blue over green, of encoded
/// values. Zero is the neutral light of the camera's own white balance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LightColor {
    /// Logarithm of red over green.
    pub log_red: f32,
    /// Logarithm of blue over green.
    pub log_blue: f32,
}

impl LightColor {
    /// Light of a frame: the least deviation from neutral light under which the scene's mean is
    /// grey within what its own colours explain. `None` when nearly all pixels are black or
    /// saturated.
    ///
    /// A small deviation is thus taken for the colour of table and room, and leaves the colours
    /// as they are; of a large one, that of a lamp, the larger part is removed.
    ///
    /// *Source*: the grey-world assumption of Buchsbaum, "A spatial processor model for object
    /// colour perception", 1980, with a tolerance of our own.
    pub fn of_frame(cloud: &[Point]) -> Option<Self> {
        // An odd step does not run along the columns of an image.
        let step = (cloud.len() / N_SAMPLES) | 1;
        let (mut sums, mut n) = ([0_u32; 3], 0_usize);
        for point in cloud.iter().step_by(step) {
            let rgb = point.color.rgb();
            if rgb.iter().all(|&channel| channel <= SATURATED) {
                n += 1;
                for (sum, channel) in sums.iter_mut().zip(rgb) {
                    *sum += u32::from(channel);
                }
            }
        }
        if n < N_SAMPLES_MIN || sums.contains(&0) {
            return None;
        }
        let [red, green, blue] = sums.map(|sum| sum as f32);
        let mean = Self {
            log_red: (red / green).ln(),
            log_blue: (blue / green).ln(),
        };
        let length = mean.log_red.hypot(mean.log_blue);
        let kept = (1.0 - SCENE_TOLERANCE / length.max(SCENE_TOLERANCE)).max(0.0);
        Some(mean.scaled(kept))
    }

    /// This light moved towards another by a share, 0 to 1.
    #[must_use]
    pub fn blended(self, other: Self, share: f32) -> Self {
        let between = |from: f32, to: f32| from + share * (to - from);
        Self {
            log_red: between(self.log_red, other.log_red),
            log_blue: between(self.log_blue, other.log_blue),
        }
    }

    fn scaled(self, factor: f32) -> Self {
        Self {
            log_red: factor * self.log_red,
            log_blue: factor * self.log_blue,
        }
    }
}

/// White balance: one gain for each channel of the encoded image.
///
/// *Source*: adaptation by independent gains is that of von Kries, "Die Gesichtsempfindungen",
/// 1905.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhiteBalance {
    gains: [f32; 3],
}

impl Default for WhiteBalance {
    fn default() -> Self {
        Self::NEUTRAL
    }
}

impl From<LightColor> for WhiteBalance {
    /// White balance that makes a light neutral and keeps the sum of a grey pixel's channels. Its
    /// gains lie between 0.25 and 4; a light that is not finite counts as neutral.
    fn from(light: LightColor) -> Self {
        if !light.log_red.is_finite() || !light.log_blue.is_finite() {
            return Self::NEUTRAL;
        }
        let limited = |gain: f32| gain.clamp(GAIN_MIN, GAIN_MAX);
        let gains = [-light.log_red, 0.0, -light.log_blue].map(|log| limited(log.exp()));
        let scale = 3.0 / gains.iter().sum::<f32>();
        Self {
            gains: gains.map(|gain| limited(gain * scale)),
        }
    }
}

impl WhiteBalance {
    /// White balance that changes nothing.
    pub const NEUTRAL: Self = Self { gains: [1.0; 3] };

    /// Balanced red, green and blue of a colour, 0 to 255.
    #[inline]
    pub fn rgb(&self, color: Rgba) -> [f32; 3] {
        let balanced = |channel: u8, gain: f32| (f32::from(channel) * gain).min(255.0);
        let ([red, green, blue], [of_red, of_green, of_blue]) = (color.rgb(), self.gains);
        [
            balanced(red, of_red),
            balanced(green, of_green),
            balanced(blue, of_blue),
        ]
    }

    /// Balanced colour, rounded.
    #[inline]
    pub fn color(&self, color: Rgba) -> Rgba {
        let [red, green, blue] = self.rgb(color);
        Rgba::opaque(red.round() as u8, green.round() as u8, blue.round() as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(colors: &[[u8; 3]]) -> Vec<Point> {
        let color = |i: usize| {
            let [red, green, blue] = colors[i % colors.len()];
            Point::without_depth(Rgba::opaque(red, green, blue))
        };
        (0..640 * 48).map(color).collect()
    }

    #[test]
    fn white_balance_leaves_the_colours_of_a_wooden_table() {
        let oak = frame(&[[178, 150, 130], [128, 128, 128]]);
        assert_eq!(LightColor::of_frame(&oak), Some(LightColor::default()));
        let balance = WhiteBalance::from(LightColor::default());
        let color = Rgba::opaque(178, 150, 130);
        assert_eq!(balance.color(color), color);
    }

    #[test]
    fn white_balance_removes_most_of_a_lamp() {
        // Grey surfaces under an orange lamp.
        let lit = frame(&[[200, 120, 60], [100, 60, 30], [150, 90, 45]]);
        let light = LightColor::of_frame(&lit).unwrap();
        let [red, green, blue] = WhiteBalance::from(light).rgb(Rgba::opaque(150, 90, 45));
        assert!(
            (red / green).ln() < 0.2 && (green / blue).ln() < 0.2,
            "{red} {green} {blue}"
        );
        let sum = red + green + blue;
        assert!((sum - 285.0).abs() < 60.0, "{sum}");
    }

    #[test]
    fn white_balance_of_a_dark_saturated_or_broken_frame_is_none_or_neutral() {
        for color in [[0; 3], [255; 3], [0, 200, 0]] {
            assert_eq!(LightColor::of_frame(&frame(&[color])), None, "{color:?}");
        }
        assert_eq!(LightColor::of_frame(&[]), None);
        let broken = LightColor {
            log_red: f32::NAN,
            log_blue: f32::INFINITY,
        };
        assert_eq!(WhiteBalance::from(broken), WhiteBalance::NEUTRAL);
        let extreme = LightColor {
            log_red: 50.0,
            log_blue: -50.0,
        };
        let rgb = WhiteBalance::from(extreme).rgb(Rgba::opaque(255, 255, 255));
        assert!(
            rgb.iter().all(|channel| (0.0..=255.0).contains(channel)),
            "{rgb:?}"
        );
    }
}
