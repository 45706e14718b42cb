//! Hue-saturation histogram of an object's colours.

use crate::Rgba;

/// Number of hue bins around the colour circle.
const N_HUES: usize = 8;

/// Number of saturation bins of the histogram.
const N_SATURATIONS: usize = 4;

/// Number of brightness bins for achromatic colours.
const N_GREYS: usize = 4;

const N_BINS: usize = N_HUES * N_SATURATIONS + N_GREYS;

/// Chroma, of 255, below which hue is noise. Chosen.
const CHROMA_MIN: f32 = 12.0;

/// Chroma range, of 255, over which the weight of hue rises to 1. Chosen.
const CHROMA_RAMP: f32 = 32.0;

/// Prior mass of each bin, which damps the influence of a few outlier points. Chosen.
const BIN_PRIOR: f32 = 0.02 / N_BINS as f32;

/// Normalised colour histogram: 8 x 4 bins of hue and saturation, 4 bins of brightness
/// for achromatic colours. Linear interpolation between bins avoids jumps at their
/// borders. The sum is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorHistogram([f32; N_BINS]);

impl Default for ColorHistogram {
    /// Uniform histogram, for an unknown colour.
    fn default() -> Self {
        Self([1.0 / N_BINS as f32; N_BINS])
    }
}

impl ColorHistogram {
    /// Histogram of the given colours; [`default`](Self::default) without any.
    pub fn from_colors(colors: impl IntoIterator<Item = Rgba>) -> Self {
        let mut bins = [BIN_PRIOR; N_BINS];
        let mut n = 0_u32;
        for color in colors {
            for_each_bin(color, |bin, weight| bins[bin] += weight);
            n += 1;
        }
        if n == 0 {
            return Self::default();
        }
        let sum: f32 = bins.iter().sum();
        Self(bins.map(|bin| bin / sum))
    }

    /// Bhattacharyya coefficient (Bhattacharyya 1943): 1 for equal histograms, 0 for
    /// disjoint ones.
    pub fn similarity(&self, other: &Self) -> f64 {
        let products = self.0.iter().zip(&other.0).map(|(a, b)| (a * b).sqrt());
        f64::from(products.sum::<f32>()).clamp(0.0, 1.0)
    }

    /// Share of a colour's bins, each weighted by its share of the colour: 0 to 1.
    pub fn density(&self, color: Rgba) -> f32 {
        let mut density = 0.0;
        for_each_bin(color, |bin, weight| density += weight * self.0[bin]);
        density
    }

    /// Exponential moving average: this histogram moved towards another by a fraction, 0
    /// to 1.
    #[must_use]
    pub fn blended(&self, other: &Self, share: f32) -> Self {
        let share = share.clamp(0.0, 1.0);
        Self(std::array::from_fn(|i| {
            self.0[i] + share * (other.0[i] - self.0[i])
        }))
    }
}

/// Visits the bins of one colour with their weights, which sum to 1.
fn for_each_bin(color: Rgba, mut visit: impl FnMut(usize, f32)) {
    let [red, green, blue] = color.rgb();
    let [red, green, blue] = [f32::from(red), f32::from(green), f32::from(blue)];
    let value = red.max(green).max(blue);
    let chroma = value - red.min(green).min(blue);
    let colored = ((chroma - CHROMA_MIN) / CHROMA_RAMP).clamp(0.0, 1.0);
    if colored < 1.0 {
        let (first, second, share) = interpolation_bins(value / 256.0, N_GREYS);
        let greys = N_HUES * N_SATURATIONS;
        visit(greys + first, (1.0 - colored) * (1.0 - share));
        visit(greys + second, (1.0 - colored) * share);
    }
    if colored > 0.0 {
        let sector = if value == red {
            (green - blue) / chroma
        } else if value == green {
            2.0 + (blue - red) / chroma
        } else {
            4.0 + (red - green) / chroma
        };
        let around = sector.rem_euclid(6.0) / 6.0 * N_HUES as f32;
        let hue = around.floor();
        let hue_share = around - hue;
        let hues = [hue as usize % N_HUES, (hue as usize + 1) % N_HUES];
        let (low, high, share) = interpolation_bins(chroma / value.max(1.0), N_SATURATIONS);
        for (hue, weight) in hues.into_iter().zip([1.0 - hue_share, hue_share]) {
            visit(hue * N_SATURATIONS + low, colored * weight * (1.0 - share));
            visit(hue * N_SATURATIONS + high, colored * weight * share);
        }
    }
}

/// Two nearest bins of a value from 0 to 1, and the weight of the second.
fn interpolation_bins(value: f32, n_bins: usize) -> (usize, usize, f32) {
    let place = (value * n_bins as f32 - 0.5).clamp(0.0, n_bins as f32 - 1.0);
    let first = place.floor();
    let second = (first as usize + 1).min(n_bins - 1);
    (first as usize, second, place - first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn uniform(red: u8, green: u8, blue: u8) -> ColorHistogram {
        ColorHistogram::from_colors([Rgba::opaque(red, green, blue); 50])
    }

    #[test]
    fn similarity_separates_colours_but_not_illumination() {
        let red = uniform(180, 30, 30);
        assert!(red.similarity(&uniform(30, 30, 180)) < 0.1);
        assert!(red.similarity(&uniform(30, 160, 40)) < 0.1);
        assert!(uniform(230, 230, 230).similarity(&uniform(25, 25, 25)) < 0.1);
        // The same surface at half of the illumination.
        assert!(red.similarity(&uniform(90, 15, 15)) > 0.95);
    }

    #[test]
    fn the_empty_histogram_is_uniform() {
        let none = ColorHistogram::from_colors([]);
        assert_eq!(none, ColorHistogram::default());
        assert!(none.similarity(&uniform(180, 30, 30)) > 0.05);
    }

    #[test]
    fn density_is_high_for_the_colours_of_the_histogram() {
        let red = uniform(180, 30, 30);
        assert!(red.density(Rgba::opaque(170, 35, 30)) > 0.3);
        assert!(red.density(Rgba::opaque(30, 30, 180)) < 0.01);
    }

    proptest! {
        #[test]
        fn a_histogram_sums_to_one_and_is_similar_to_itself(colors in prop::collection::vec(any::<[u8; 3]>(), 0..60)) {
            let of = || ColorHistogram::from_colors(colors.iter().map(|[r, g, b]| Rgba::opaque(*r, *g, *b)));
            let histogram = of();
            prop_assert!((histogram.0.iter().sum::<f32>() - 1.0).abs() < 1e-4);
            prop_assert!(histogram.0.iter().all(|bin| *bin >= 0.0));
            prop_assert!(histogram.similarity(&of()) > 0.999);
        }

        #[test]
        fn small_noise_changes_the_similarity_little(color in any::<[u8; 3]>(), noise in prop::array::uniform3(-3..=3_i16)) {
            let noisy: [u8; 3] = std::array::from_fn(|i| (i16::from(color[i]) + noise[i]).clamp(0, 255) as u8);
            let (a, b) = (uniform(color[0], color[1], color[2]), uniform(noisy[0], noisy[1], noisy[2]));
            prop_assert!(a.similarity(&b) > 0.8, "{}", a.similarity(&b));
        }

        #[test]
        fn blending_interpolates_between_histograms(share in 0.0..1.0_f32) {
            let (a, b) = (uniform(200, 40, 40), uniform(40, 40, 200));
            let mixed = a.blended(&b, share);
            prop_assert!((mixed.0.iter().sum::<f32>() - 1.0).abs() < 1e-4);
            prop_assert!(mixed.similarity(&b) + 1e-6 >= a.similarity(&b));
        }
    }
}
