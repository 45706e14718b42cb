//! Colour histograms of an object: chromaticity and lightness.

use super::soft_bins::{SoftBins, add, add_linear, normalise_fourth_roots};
use crate::ObjectPoints;

/// Chromaticity bins per side.
pub(super) const CHROMATICITY_SIDE: usize = 8;

/// Number of chromaticity cells.
pub(super) const N_CHROMATICITIES: usize = CHROMATICITY_SIDE * CHROMATICITY_SIDE;

/// Number of lightness bins.
const N_LIGHTNESSES: usize = 8;

/// Number of colour values of a descriptor.
pub(super) const N_COLORS: usize = N_CHROMATICITIES + N_LIGHTNESSES;

/// Lower end of the chromaticity bins, as a fraction of red or green. Chosen.
const CHROMATICITY_MIN: f32 = 0.1;

/// Width of the chromaticity range. Chosen.
const CHROMATICITY_RANGE: f32 = 0.6;

/// Offset added to each channel, of 255, because the chromaticity of nearly black pixels
/// is noise. Chosen.
const CHANNEL_OFFSET: f32 = 16.0;

/// Weight of lightness relative to chromaticity, since the strength of illumination
/// varies. Chosen.
const LIGHTNESS_WEIGHT: f32 = 0.55;

/// Histograms of chromaticity and lightness, reused from object to object.
#[derive(Debug, Clone)]
pub(super) struct ColorHistograms {
    chromaticities: [f32; N_CHROMATICITIES],
    lightnesses: [f32; N_LIGHTNESSES],
}

impl ColorHistograms {
    pub(super) fn new() -> Self {
        Self {
            chromaticities: [0.0; N_CHROMATICITIES],
            lightnesses: [0.0; N_LIGHTNESSES],
        }
    }

    /// Appends the colour values, multiplied by `weight`: the chromaticity histogram
    /// over the fractions of red and green, which are invariant to the strength of
    /// illumination, then lightness.
    pub(super) fn append(&mut self, points: ObjectPoints<'_>, weight: f32, out: &mut Vec<f32>) {
        self.chromaticities.fill(0.0);
        self.lightnesses.fill(0.0);
        let (sides, lightness_bins) = (
            SoftBins::new(CHROMATICITY_SIDE),
            SoftBins::new(N_LIGHTNESSES),
        );
        points.for_each(|point| {
            if !point.is_finite() {
                return;
            }
            let [red, green, blue] = points.white_balance().rgb(point.color);
            let sum = red + green + blue;
            let place = |channel: f32| {
                let share = (channel + CHANNEL_OFFSET) / (sum + 3.0 * CHANNEL_OFFSET);
                sides.locate((share - CHROMATICITY_MIN) / CHROMATICITY_RANGE)
            };
            add(
                &mut self.chromaticities,
                CHROMATICITY_SIDE,
                place(red),
                place(green),
            );
            let bin = lightness_bins.locate(sum / (3.0 * 255.0));
            add_linear(&mut self.lightnesses, bin, 1.0);
        });
        normalise_fourth_roots(&mut self.chromaticities);
        normalise_fourth_roots(&mut self.lightnesses);
        out.extend(self.chromaticities.iter().map(|value| weight * value));
        let weight = weight * LIGHTNESS_WEIGHT;
        out.extend(self.lightnesses.iter().map(|value| weight * value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::{Point, Rgba};

    fn block(color: Rgba) -> Vec<f32> {
        let cloud = [Point {
            color,
            ..Point::default()
        }; 9];
        let mut out = Vec::new();
        ColorHistograms::new().append(ObjectPoints::all(&cloud), 1.0, &mut out);
        out
    }

    fn distance(a: &[f32], b: &[f32]) -> f32 {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f32>().sqrt()
    }

    #[test]
    fn illumination_changes_the_colour_less_than_hue() {
        let red = block(Rgba::opaque(180, 40, 30));
        let dim_red = block(Rgba::opaque(140, 31, 23));
        let blue = block(Rgba::opaque(30, 40, 180));
        assert_eq!(red.len(), N_COLORS);
        assert!(2.0 * distance(&red, &dim_red) < distance(&red, &blue));
    }

    #[test]
    fn noise_of_black_pixels_is_not_colour() {
        let black = block(Rgba::opaque(2, 3, 1));
        assert!(distance(&black, &block(Rgba::opaque(3, 1, 2))) < 0.5);
    }

    #[test]
    fn white_and_black_differ() {
        let (white, black) = (Rgba::opaque(230, 230, 230), Rgba::opaque(20, 20, 20));
        assert!(distance(&block(white), &block(black)) > 0.5);
    }
}
