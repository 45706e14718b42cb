//! Debounced log of the depth noise measured on the table.

/// Least ratio to the configured law that is noise worth a line. Chosen.
const NOTABLE_RATIO: f32 = 1.3;

/// Least change of the ratio, as a factor, for another line. Chosen.
const CHANGE_FACTOR: f32 = 1.5;

/// Log of the noise ratio: a line for a notable one, and for each large change.
#[derive(Debug, Default)]
pub(crate) struct NoiseLog {
    /// Ratio logged last; `None` before the first.
    logged: Option<f32>,
}

impl NoiseLog {
    /// Logs a change of the ratio; `None` while it is not measured.
    pub(crate) fn update(&mut self, ratio: Option<f32>) {
        if let Some(ratio) = ratio.and_then(|ratio| self.changed_ratio(ratio)) {
            tracing::info!(
                "the depth noise and warp measured on the table is {ratio:.1} times that of \
                 [perception] depth_noise; detection and tracking allow for it"
            );
        }
    }

    /// Ratio to log for a frame with the ratio `ratio`; `None` when it changed little.
    fn changed_ratio(&mut self, ratio: f32) -> Option<f32> {
        let is_change = match self.logged {
            None => ratio >= NOTABLE_RATIO,
            Some(last) => ratio / last >= CHANGE_FACTOR || last / ratio >= CHANGE_FACTOR,
        };
        is_change.then(|| *self.logged.insert(ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notable_noise_is_logged_once_and_each_large_change() {
        let mut log = NoiseLog::default();
        let ratios = [1.0, 1.2, 2.0, 2.2, 1.9, 3.5, 1.0, 1.0];
        let lines = ratios.map(|ratio| log.changed_ratio(ratio));
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
