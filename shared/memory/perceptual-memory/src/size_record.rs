//! Size record: size of the store by day, for a forecast of the disk space.
//!
//! It is no part of the history, and begins anew after a rebuild.

use serde::{Deserialize, Serialize};

/// Time between two samples: a day, nanoseconds.
const PERIOD_NS: u64 = 24 * 3600 * 1_000_000_000;
/// Number of samples kept.
const MAX_SAMPLES: usize = 32;
/// Days of a year.
const YEAR_DAYS: f64 = 365.0;

/// Sizes of the store, oldest first.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct SizeRecord {
    /// Time, nanoseconds since 1970, UTC, and size of database and archive, bytes.
    samples: Vec<(u64, u64)>,
}

impl SizeRecord {
    /// `true` if the last sample is a day old, or the clock is behind it.
    pub(crate) fn is_due(&self, wall_ns: u64) -> bool {
        let last = self.samples.last();
        last.is_none_or(|(ns, _)| !(*ns..ns.saturating_add(PERIOD_NS)).contains(&wall_ns))
    }

    pub(crate) fn add(&mut self, wall_ns: u64, n_bytes: u64) {
        // Samples from the future are those of a clock that was wrong.
        self.samples.retain(|(ns, _)| *ns < wall_ns);
        self.samples.push((wall_ns, n_bytes));
        let n_old = self.samples.len().saturating_sub(MAX_SAMPLES);
        self.samples.drain(..n_old);
    }

    /// Size in a year, bytes, if it goes on as since the oldest sample; `None` before a day has
    /// passed. A store does not shrink by this forecast.
    pub(crate) fn forecast(&self, wall_ns: u64, n_bytes: u64) -> Option<u64> {
        let (oldest_ns, oldest_bytes) = self.samples.first()?;
        let passed_ns = wall_ns.checked_sub(*oldest_ns)?;
        if passed_ns < PERIOD_NS {
            return None;
        }
        let days = passed_ns as f64 / PERIOD_NS as f64;
        let growth = n_bytes.saturating_sub(*oldest_bytes) as f64 / days;
        Some(n_bytes.saturating_add((growth * YEAR_DAYS) as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_in_a_year_follows_from_the_growth() {
        let mut sizes = SizeRecord::default();
        assert!(sizes.is_due(5));
        sizes.add(0, 1000);
        assert!(!sizes.is_due(PERIOD_NS - 1) && sizes.is_due(PERIOD_NS));
        assert_eq!(sizes.forecast(PERIOD_NS - 1, 2000), None);
        assert_eq!(sizes.forecast(2 * PERIOD_NS, 1200), Some(1200 + 36_500));
        assert_eq!(sizes.forecast(2 * PERIOD_NS, 900), Some(900));
        for day in 1..100 {
            sizes.add(day * PERIOD_NS, 1000 + day);
        }
        assert_eq!(sizes.samples.len(), MAX_SAMPLES);
        assert_eq!(sizes.forecast(100 * PERIOD_NS, 1100), Some(1100 + 365));
        // The clock was set back: what lies ahead of it does not count.
        assert!(sizes.is_due(3 * PERIOD_NS));
        sizes.add(3 * PERIOD_NS, 2000);
        assert_eq!(sizes.samples, [(3 * PERIOD_NS, 2000)]);
    }
}
