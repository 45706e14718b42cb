//! Debounced log of the depth noise measured on the table.

use detection::Table;

/// Number of frames of one measurement. Chosen (1 s at 30 Hz).
const N_FRAMES: u32 = 30;

/// Least ratio to the configured law that is noise worth a line. Chosen.
const NOTABLE_RATIO: f32 = 1.3;

/// Least change of the ratio, as a factor, for another line. Chosen.
const CHANGE_FACTOR: f32 = 1.5;

/// Mean of the noise ratio over windows of frames; logs a notable one, and each large change.
#[derive(Debug, Default)]
pub(crate) struct NoiseLog {
    sum: f32,
    n: u32,
    /// Ratio logged last; `None` before the first window.
    logged: Option<f32>,
}

impl NoiseLog {
    /// Counts a frame's table and logs a change of the noise on it.
    pub(crate) fn update(&mut self, table: Option<&Table>) {
        if let Some(ratio) = table.and_then(|table| self.changed_ratio(table.noise_ratio)) {
            tracing::info!(
                "the depth noise and warp measured on the table is {ratio:.1} times that of \
                 [perception] depth_noise; detection allows for it"
            );
        }
    }

    /// Ratio to log after a frame with the ratio `ratio`; `None` when it changed little.
    fn changed_ratio(&mut self, ratio: f32) -> Option<f32> {
        self.sum += ratio;
        self.n += 1;
        if self.n < N_FRAMES {
            return None;
        }
        let mean = self.sum / N_FRAMES as f32;
        (self.sum, self.n) = (0.0, 0);
        let is_change = match self.logged {
            None => mean >= NOTABLE_RATIO,
            Some(last) => mean / last >= CHANGE_FACTOR || last / mean >= CHANGE_FACTOR,
        };
        is_change.then(|| *self.logged.insert(mean))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ratios logged during windows of frames with one ratio each.
    fn logged(windows: &[f32]) -> Vec<Option<f32>> {
        let mut log = NoiseLog::default();
        let window = |&ratio: &f32| {
            let mut lines = (0..N_FRAMES).filter_map(|_| log.changed_ratio(ratio));
            lines.next().map(|ratio| (100.0 * ratio).round() / 100.0)
        };
        windows.iter().map(window).collect()
    }

    #[test]
    fn notable_noise_is_logged_once_and_each_large_change() {
        let lines = logged(&[1.0, 1.2, 2.0, 2.2, 1.9, 3.5, 1.0, 1.0]);
        let expected = [
            None,
            None,
            Some(2.0),
            None,
            None,
            Some(3.5),
            Some(1.0),
            None,
        ];
        assert_eq!(lines, expected);
    }
}
