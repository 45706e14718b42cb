//! CIELAB colour space and the CIE 1976 colour difference.

/// Sum of sRGB colours, for their mean.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ColorSum {
    n: u32,
    rgb: [u32; 3],
}

impl ColorSum {
    /// Adds a colour to the sum.
    #[inline]
    pub(crate) fn add(&mut self, rgb: [u8; 3]) {
        self.n += 1;
        for (sum, value) in self.rgb.iter_mut().zip(rgb) {
            *sum += u32::from(value);
        }
    }

    /// Adds another colour sum.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.n += other.n;
        for (sum, value) in self.rgb.iter_mut().zip(other.rgb) {
            *sum += value;
        }
    }

    /// Standard deviation of the colour values over the channels, 0 to 255, given the sum of
    /// their squares.
    pub(crate) fn sigma(&self, squares: f64) -> f32 {
        let n = 3.0 * f64::from(self.n.max(1));
        let of_means = self
            .rgb
            .map(|sum| (f64::from(sum) / f64::from(self.n.max(1))).powi(2));
        (squares / n - of_means.iter().sum::<f64>() / 3.0)
            .max(0.0)
            .sqrt() as f32
    }

    /// Mean colour; black for an empty sum.
    pub(crate) fn mean(&self) -> CieLab {
        let n = self.n.max(1) as f32;
        CieLab::from_srgb(self.rgb.map(|sum| sum as f32 / n))
    }
}

/// Colour in CIE 1976 L\*a\*b\* under the white point of sRGB (D65).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct CieLab {
    l: f32,
    a: f32,
    b: f32,
}

impl CieLab {
    /// Colour of sRGB values from 0 to 255 (IEC 61966-2-1).
    pub(crate) fn from_srgb(rgb: [f32; 3]) -> Self {
        let [r, g, b] = rgb.map(|value| {
            let value = value / 255.0;
            if value <= 0.040_45 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        });
        let lightness = |t: f32| {
            if t > 0.008_856 {
                t.cbrt()
            } else {
                7.787 * t + 16.0 / 116.0
            }
        };
        let x = lightness((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
        let y = lightness(0.2126 * r + 0.7152 * g + 0.0722 * b);
        let z = lightness((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
        Self {
            l: 116.0 * y - 16.0,
            a: 500.0 * (x - y),
            b: 200.0 * (y - z),
        }
    }

    /// Colour difference ΔE (CIE 1976); a difference of about 2 is just noticeable.
    pub(crate) fn delta_e(&self, other: &Self) -> f32 {
        let squared = |x: f32, y: f32| (x - y) * (x - y);
        (squared(self.l, other.l) + squared(self.a, other.a) + squared(self.b, other.b)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIELAB coordinates of the sRGB primaries, values of the colour science literature.
    #[test]
    fn known_colors_have_their_known_coordinates() {
        for (rgb, [l, a, b]) in [
            ([255.0, 255.0, 255.0], [100.0, 0.0, 0.0]),
            ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
            ([255.0, 0.0, 0.0], [53.24, 80.09, 67.20]),
            ([0.0, 255.0, 0.0], [87.73, -86.18, 83.18]),
            ([0.0, 0.0, 255.0], [32.30, 79.19, -107.86]),
        ] {
            let lab = CieLab::from_srgb(rgb);
            assert!(lab.delta_e(&CieLab { l, a, b }) < 0.1, "{rgb:?}: {lab:?}");
        }
    }

    #[test]
    fn the_mean_of_sums_is_the_mean_of_all() {
        let (mut left, mut right) = (ColorSum::default(), ColorSum::default());
        left.add([10, 200, 30]);
        right.add([30, 100, 30]);
        right.add([20, 0, 30]);
        left.merge(&right);
        assert_eq!(left.mean(), CieLab::from_srgb([20.0, 100.0, 30.0]));
        assert_eq!(ColorSum::default().mean(), CieLab::from_srgb([0.0; 3]));
    }
}
