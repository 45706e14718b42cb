//! Depth noise estimate of the camera: running median of the ratios measured on the table.

use detection::Detection;
use sensor_noise::DepthNoise;

/// Greatest number of frames with a table in the median: 10 s at 30 Hz, longer than a wrong
/// table lasts and shorter than a camera takes to warm up. Chosen.
const N_FRAMES_MAX: usize = 301;

/// Least number of frames with a table for a median: 1 s at 30 Hz. Chosen.
const N_FRAMES_MIN: usize = 31;

/// Least ratio at which the configured law no longer holds; below it the difference is within
/// the error of the measurement, and warp. Chosen.
const RATIO_NOTABLE: f32 = 1.3;

/// Depth noise of the camera: the configured law, and its median ratio over the last frames.
///
/// The noise of a camera does not change from frame to frame. The ratio of a single frame is
/// too high when its table is wrong or the camera moves fast, and would shake the tracks.
#[derive(Debug, Clone)]
pub(crate) struct DepthNoiseEstimate {
    configured: DepthNoise,
    ratios: [f32; N_FRAMES_MAX],
    n_measured: usize,
    ratio: Option<f32>,
}

impl Default for DepthNoiseEstimate {
    fn default() -> Self {
        Self {
            configured: DepthNoise::default(),
            ratios: [1.0; N_FRAMES_MAX],
            n_measured: 0,
            ratio: None,
        }
    }
}

impl DepthNoiseEstimate {
    /// Adds the ratio of a detection; one without a table has none.
    pub(crate) fn add(&mut self, detection: &Detection) {
        self.configured = detection.depth_noise;
        if let Some(table) = detection.table() {
            self.add_ratio(table.noise_ratio);
        }
    }

    fn add_ratio(&mut self, ratio: f32) {
        self.ratios[self.n_measured % N_FRAMES_MAX] = ratio;
        self.n_measured += 1;
        if self.n_measured >= N_FRAMES_MIN {
            let mut ratios = self.ratios;
            let known = &mut ratios[..self.n_measured.min(N_FRAMES_MAX)];
            let middle = known.len() / 2;
            let (_, median, _) = known.select_nth_unstable_by(middle, f32::total_cmp);
            self.ratio = Some(*median);
        }
    }

    /// Median ratio to the configured law; `None` before a second with a table.
    pub(crate) fn ratio(&self) -> Option<f32> {
        self.ratio
    }

    /// Depth noise law of the camera: as measured if it differs notably from the configured one,
    /// which applies before.
    pub(crate) fn law(&self) -> DepthNoise {
        match self.ratio {
            Some(ratio) if ratio >= RATIO_NOTABLE => self.configured.scaled(ratio),
            _ => self.configured,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Estimate after frames with these ratios.
    fn after(ratios: impl IntoIterator<Item = f32>) -> DepthNoiseEstimate {
        let mut estimate = DepthNoiseEstimate::default();
        ratios
            .into_iter()
            .for_each(|ratio| estimate.add_ratio(ratio));
        estimate
    }

    #[test]
    fn the_configured_law_applies_until_a_second_was_measured() {
        let mut estimate = after([3.0; N_FRAMES_MIN - 1]);
        assert_eq!(
            (estimate.ratio(), estimate.law()),
            (None, DepthNoise::KINECT_V1)
        );
        estimate.add_ratio(3.0);
        assert_eq!(estimate.law(), DepthNoise::KINECT_V1.scaled(3.0));
    }

    #[test]
    fn a_ratio_within_the_error_of_measurement_leaves_the_configured_law() {
        let estimate = after([1.15; 100]);
        assert_eq!(
            (estimate.ratio(), estimate.law()),
            (Some(1.15), DepthNoise::KINECT_V1)
        );
    }

    #[test]
    fn frames_with_a_wrong_table_do_not_change_the_noise() {
        let ratio_of = |i: usize| if i.is_multiple_of(3) { 4.0 } else { 1.2 };
        assert_eq!(after((0..400).map(ratio_of)).ratio(), Some(1.2));
    }

    #[test]
    fn the_noise_follows_a_lasting_change() {
        let ratio_after = |n| after([1.0; 500].into_iter().chain((0..n).map(|_| 2.5))).ratio();
        assert_eq!(ratio_after(N_FRAMES_MAX / 2), Some(1.0));
        assert_eq!(ratio_after(N_FRAMES_MAX / 2 + 1), Some(2.5));
    }
}
