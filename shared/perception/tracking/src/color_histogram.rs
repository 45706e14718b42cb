//! How an object is coloured.

use point_cloud::Rgba;

/// Bins of hue, red to red.
const N_HUES: usize = 8;

/// Bins of saturation.
const N_SATURATIONS: usize = 4;

/// Bins of brightness for what has no colour.
const N_GREYS: usize = 4;

const N_BINS: usize = N_HUES * N_SATURATIONS + N_GREYS;

/// Below this chroma, of 255, hue is noise; with so much more, colour counts whole.
const CHROMA_MIN: f32 = 12.0;
const CHROMA_RAMP: f32 = 32.0;

/// Share of every bin that is taken for granted, so that a few stray points do
/// not tell objects apart.
const PRIOR: f32 = 0.02 / N_BINS as f32;

/// Hue and saturation of what is coloured, brightness of what is grey: 8 x 4 + 4
/// bins, softly filled, so that a colour on the border of two bins does not jump
/// between them. Sums to one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorHistogram([f32; N_BINS]);

impl Default for ColorHistogram {
    /// Nothing known: all colours alike.
    fn default() -> Self {
        Self([1.0 / N_BINS as f32; N_BINS])
    }
}

impl ColorHistogram {
    /// The histogram of some colours; without any, [`default`](Self::default).
    pub fn of(colors: impl IntoIterator<Item = Rgba>) -> Self {
        let mut bins = [PRIOR; N_BINS];
        let mut n = 0_u32;
        for color in colors {
            add(&mut bins, color);
            n += 1;
        }
        if n == 0 {
            return Self::default();
        }
        let sum: f32 = bins.iter().sum();
        Self(bins.map(|bin| bin / sum))
    }

    /// Bhattacharyya coefficient (Bhattacharyya 1943): 1 for equal histograms, 0
    /// for those without a common bin.
    pub fn similarity(&self, other: &Self) -> f64 {
        let products = self.0.iter().zip(&other.0).map(|(a, b)| (a * b).sqrt());
        f64::from(products.sum::<f32>()).clamp(0.0, 1.0)
    }

    /// This one, moved towards another by a share, 0 to 1.
    #[must_use]
    pub fn blended(&self, other: &Self, share: f32) -> Self {
        let share = share.clamp(0.0, 1.0);
        Self(std::array::from_fn(|i| {
            self.0[i] + share * (other.0[i] - self.0[i])
        }))
    }
}

/// Adds one colour with a weight of one.
fn add(bins: &mut [f32; N_BINS], color: Rgba) {
    let [red, green, blue] = color.rgb().map(f32::from);
    let value = red.max(green).max(blue);
    let chroma = value - red.min(green).min(blue);
    let colored = ((chroma - CHROMA_MIN) / CHROMA_RAMP).clamp(0.0, 1.0);
    if colored < 1.0 {
        let (first, second, share) = neighbours(value / 256.0, N_GREYS);
        let greys = &mut bins[N_HUES * N_SATURATIONS..];
        greys[first] += (1.0 - colored) * (1.0 - share);
        greys[second] += (1.0 - colored) * share;
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
        let (low, high, share) = neighbours(chroma / value.max(1.0), N_SATURATIONS);
        for (hue, weight) in hues.into_iter().zip([1.0 - hue_share, hue_share]) {
            bins[hue * N_SATURATIONS + low] += colored * weight * (1.0 - share);
            bins[hue * N_SATURATIONS + high] += colored * weight * share;
        }
    }
}

/// The two bins nearest to a value from 0 to 1, and the share of the second.
fn neighbours(value: f32, n_bins: usize) -> (usize, usize, f32) {
    let place = (value * n_bins as f32 - 0.5).clamp(0.0, n_bins as f32 - 1.0);
    let first = place.floor();
    let second = (first as usize + 1).min(n_bins - 1);
    (first as usize, second, place - first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plain(red: u8, green: u8, blue: u8) -> ColorHistogram {
        ColorHistogram::of([Rgba::opaque(red, green, blue); 50])
    }

    #[test]
    fn unlike_colours_are_told_apart_and_light_is_not() {
        let red = plain(180, 30, 30);
        assert!(red.similarity(&plain(30, 30, 180)) < 0.1);
        assert!(red.similarity(&plain(30, 160, 40)) < 0.1);
        assert!(plain(230, 230, 230).similarity(&plain(25, 25, 25)) < 0.1);
        // The same paint in half of the light.
        assert!(red.similarity(&plain(90, 15, 15)) > 0.95);
    }

    #[test]
    fn nothing_is_like_everything_a_little() {
        let none = ColorHistogram::of([]);
        assert_eq!(none, ColorHistogram::default());
        assert!(none.similarity(&plain(180, 30, 30)) > 0.05);
    }

    proptest! {
        #[test]
        fn a_histogram_sums_to_one_and_is_like_itself(colors in prop::collection::vec(any::<[u8; 3]>(), 0..60)) {
            let of = || ColorHistogram::of(colors.iter().map(|[r, g, b]| Rgba::opaque(*r, *g, *b)));
            let histogram = of();
            prop_assert!((histogram.0.iter().sum::<f32>() - 1.0).abs() < 1e-4);
            prop_assert!(histogram.0.iter().all(|bin| *bin >= 0.0));
            prop_assert!(histogram.similarity(&of()) > 0.999);
        }

        #[test]
        fn a_little_noise_changes_little(color in any::<[u8; 3]>(), noise in prop::array::uniform3(-3..=3_i16)) {
            let noisy: [u8; 3] = std::array::from_fn(|i| (i16::from(color[i]) + noise[i]).clamp(0, 255) as u8);
            let (a, b) = (plain(color[0], color[1], color[2]), plain(noisy[0], noisy[1], noisy[2]));
            prop_assert!(a.similarity(&b) > 0.8, "{}", a.similarity(&b));
        }

        #[test]
        fn blending_goes_from_the_one_to_the_other(share in 0.0..1.0_f32) {
            let (a, b) = (plain(200, 40, 40), plain(40, 40, 200));
            let mixed = a.blended(&b, share);
            prop_assert!((mixed.0.iter().sum::<f32>() - 1.0).abs() < 1e-4);
            prop_assert!(mixed.similarity(&b) + 1e-6 >= a.similarity(&b));
        }
    }
}
