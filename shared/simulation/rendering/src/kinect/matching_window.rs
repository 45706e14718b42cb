//! Window matching of a stereo camera: disparity averaged over the window, with correlated noise.

use super::noise_tables::{NoiseKey, NoisePurpose, NoiseTables};
use std::ops::Range;
use value_range::{OutOfRange, check_range};

/// Greatest radius of the window, pixels.
const RADIUS_MAX_PX: usize = 16;
/// Number of pixels that share one position in the noise tables.
const BLOCK_PX: usize = 160;

/// Window matching: the disparity of a pixel is the mean over a square window, whose neighbours
/// therefore share most of their noise.
///
/// A stereo camera compares windows, not pixels. Small steps inside a window are rounded to ramps;
/// a surface whose disparity differs by more than `capture_px` does not match together with the
/// window's middle and takes no part. The noise forms bumps of the size of the window, as the depth
/// images of active stereo cameras show them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatchingWindow {
    /// Radius of the window, pixels: it is 2·radius + 1 wide and high; 1 to 16.
    pub radius_px: usize,
    /// Greatest difference of disparity within which surfaces are averaged, pixels; 0 to 10.
    pub capture_px: f32,
    /// Standard deviation of the averaged disparity on a plane, pixels; 0 to 1.
    pub noise_px: f32,
}

impl MatchingWindow {
    /// Active stereo camera of 5 cm baseline. Noise and its correlation are those of the table in
    /// depth images of a `RealSense`: 0.04 to 0.07 pixels, halved at 4 to 8 pixels; Intel states less
    /// than 0.1 pixels. The capture is an estimate from pictures.
    pub const STEREO: Self = Self {
        radius_px: 4,
        capture_px: 0.6,
        noise_px: 0.06,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        let radius = self.radius_px as f32;
        check_range(
            "matching_window.radius_px",
            radius,
            1.0,
            RADIUS_MAX_PX as f32,
        )?;
        check_range("matching_window.capture_px", self.capture_px, 0.0, 10.0)?;
        check_range("matching_window.noise_px", self.noise_px, 0.0, 1.0)
    }

    /// Matches an image of disparities, `width` pixels per row; 0 stands for empty pixels, which
    /// stay empty. `scratch` is a buffer of the same size.
    pub(super) fn apply(
        &self,
        disparity: &mut [f32],
        scratch: &mut [f32],
        width: usize,
        (key, tables): (&NoiseKey, &NoiseTables),
    ) {
        if self.noise_px > 0.0 {
            self.add_noise(disparity, scratch, width, key, tables);
        }
        self.average_captured(disparity, scratch, width);
    }

    /// Averages along the rows, then along the columns.
    fn average_captured(&self, disparity: &mut [f32], scratch: &mut [f32], width: usize) {
        let height = disparity.len() / width;
        let rows = disparity.chunks_exact(width);
        for (line, averaged) in rows.zip(scratch.chunks_exact_mut(width)) {
            for (column, averaged) in averaged.iter_mut().enumerate() {
                let window = &line[self.window(column, width)];
                *averaged = self.captured_mean(line[column], window.iter().copied());
            }
        }
        for row in 0..height {
            for column in 0..width {
                let window = self
                    .window(row, height)
                    .map(|v| scratch[v * width + column]);
                disparity[row * width + column] =
                    self.captured_mean(scratch[row * width + column], window);
            }
        }
    }

    /// Adds noise that is averaged over the window once, and will be by the matching once more: of
    /// w normal values along a side, this leaves (2w² + 1)/(3w³) of the variance, so that the
    /// standard deviation in both directions together is as much.
    ///
    /// Each row holds the running sum of its own normal values, and each pixel takes the rows of
    /// its window.
    fn add_noise(
        &self,
        disparity: &mut [f32],
        scratch: &mut [f32],
        width: usize,
        key: &NoiseKey,
        tables: &NoiseTables,
    ) {
        let height = disparity.len() / width;
        let side = (2 * self.radius_px + 1) as f32;
        let left = (2.0 * side * side + 1.0) / (3.0 * side.powi(3));
        let factor = self.noise_px / (left * side * side);
        for (row, line) in scratch.chunks_exact_mut(width).enumerate() {
            for (block, values) in line.chunks_mut(BLOCK_PX).enumerate() {
                let hash = key.hash(NoisePurpose::Matching, row, block);
                let normal = tables.normal(hash, values.len() + 2 * self.radius_px);
                let windows = normal.windows(2 * self.radius_px + 1);
                for (value, window) in values.iter_mut().zip(windows) {
                    *value = factor * window.iter().sum::<f32>();
                }
            }
        }
        for row in 0..height {
            for line in self.window(row, height) {
                let pixels = disparity[row * width..][..width].iter_mut();
                for (pixel, noise) in pixels.zip(&scratch[line * width..][..width]) {
                    *pixel += if *pixel > 0.0 { *noise } else { 0.0 };
                }
            }
        }
    }

    /// Indices of the window around one of `len` pixels.
    #[inline]
    fn window(&self, middle: usize, len: usize) -> Range<usize> {
        middle.saturating_sub(self.radius_px)..len.min(middle + self.radius_px + 1)
    }

    /// Mean of the values that are captured with the middle one; 0 if that is empty.
    #[inline]
    fn captured_mean(&self, middle_px: f32, values: impl Iterator<Item = f32>) -> f32 {
        if middle_px <= 0.0 {
            return 0.0;
        }
        let (mut sum, mut n) = (0.0, 0.0_f32);
        for value in values {
            let is_captured = value > 0.0 && (value - middle_px).abs() <= self.capture_px;
            sum += if is_captured { value } else { 0.0 };
            n += if is_captured { 1.0 } else { 0.0 };
        }
        sum / n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 160;

    fn matched(window: MatchingWindow, mut disparity: Vec<f32>) -> Vec<f32> {
        let mut scratch = vec![0.0; disparity.len()];
        let (key, tables) = (NoiseKey::new(1, 1), NoiseTables::new());
        window.apply(&mut disparity, &mut scratch, WIDTH, (&key, &tables));
        disparity
    }

    #[test]
    fn noise_has_its_standard_deviation_and_neighbours_share_it() {
        let plane = matched(MatchingWindow::STEREO, vec![30.0; WIDTH * 620]);
        let noise: Vec<f32> = plane.iter().map(|d| d - 30.0).collect();
        let inner: Vec<usize> = (10..600)
            .flat_map(|r| (0..150).map(move |c| r * WIDTH + c))
            .collect();
        let mean = |product: &dyn Fn(usize) -> f32| {
            inner.iter().map(|&i| product(i)).sum::<f32>() / inner.len() as f32
        };
        let variance = mean(&|i| noise[i] * noise[i]);
        assert!(
            (variance.sqrt() / 0.06 - 1.0).abs() < 0.15,
            "{}",
            variance.sqrt()
        );
        let below = mean(&|i| noise[i] * noise[i + WIDTH]) / variance;
        assert!((0.9..1.0).contains(&below), "{below}");
        let far = mean(&|i| noise[i] * noise[i + 16 * WIDTH]) / variance;
        assert!(far.abs() < 0.25, "{far}");
    }

    #[test]
    fn small_steps_become_ramps_and_large_ones_stay() {
        let window = MatchingWindow {
            noise_px: 0.0,
            ..MatchingWindow::STEREO
        };
        let step = |height: f32| {
            let row: Vec<f32> = (0..WIDTH)
                .map(|u| 30.0 + if u < 80 { 0.0 } else { height })
                .collect();
            let image = row.repeat(20);
            matched(window, image)[10 * WIDTH..11 * WIDTH].to_vec()
        };
        let small = step(0.4);
        assert!(
            (small[79] - 30.0 - 0.4 * 4.0 / 9.0).abs() < 1e-3,
            "{}",
            small[79]
        );
        assert!(small[70] == 30.0 && (small[90] - 30.4).abs() < 1e-4);
        let large = step(3.0);
        assert!(large[79] == 30.0 && (large[80] - 33.0).abs() < 1e-4);
    }

    #[test]
    fn empty_pixels_stay_empty_and_do_not_take_part() {
        let mut image = vec![30.0; WIDTH * 20];
        image[10 * WIDTH + 50] = 0.0;
        let window = MatchingWindow {
            noise_px: 0.0,
            ..MatchingWindow::STEREO
        };
        let matched = matched(window, image);
        assert_eq!(matched[10 * WIDTH + 50], 0.0);
        assert_eq!(matched[10 * WIDTH + 51], 30.0);
    }
}
