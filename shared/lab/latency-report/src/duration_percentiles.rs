//! Nearest-rank percentiles of durations.

use serde::{Deserialize, Serialize};
use statistics::percentiles::nearest_rank;

const NS_PER_MS: f64 = 1e6;

/// Percentiles of durations, milliseconds, by nearest rank.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DurationPercentiles {
    /// Median (50th percentile) of the durations.
    pub p50: f64,
    /// 90th percentile of the durations.
    pub p90: f64,
    /// 99th percentile of the durations.
    pub p99: f64,
    /// 99.9th percentile of the durations.
    pub p999: f64,
    /// Maximum duration.
    pub max: f64,
}

/// Name of a percentile and its accessor.
pub type NamedPercentile = (&'static str, fn(&DurationPercentiles) -> f64);

impl DurationPercentiles {
    /// Percentiles of durations in nanoseconds, which are sorted in place; all 0 for no
    /// durations.
    pub fn of(durations_ns: &mut [u64]) -> Self {
        durations_ns.sort_unstable();
        Self::of_quantiles(|share| nearest_rank(durations_ns, share).unwrap_or(0))
    }

    /// Percentiles by a function from a share, 0 to 1, to nanoseconds.
    pub(crate) fn of_quantiles(at_ns: impl Fn(f64) -> u64) -> Self {
        let at = |share: f64| at_ns(share) as f64 / NS_PER_MS;
        Self {
            p50: at(0.5),
            p90: at(0.9),
            p99: at(0.99),
            p999: at(0.999),
            max: at(1.0),
        }
    }

    /// Percentiles by the names used in files.
    pub const NAMED: [NamedPercentile; 5] = [
        ("p50", |p| p.p50),
        ("p90", |p| p.p90),
        ("p99", |p| p.p99),
        ("p999", |p| p.p999),
        ("max", |p| p.max),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_durations_by_nearest_rank() {
        let mut durations: Vec<u64> = (1..=1000).rev().map(|ms| ms * 1_000_000).collect();
        let expected = DurationPercentiles {
            p50: 500.0,
            p90: 900.0,
            p99: 990.0,
            p999: 999.0,
            max: 1000.0,
        };
        assert_eq!(DurationPercentiles::of(&mut durations), expected);
        assert_eq!(DurationPercentiles::of(&mut [2_000_000]).p50, 2.0);
        assert_eq!(
            DurationPercentiles::of(&mut []),
            DurationPercentiles::default()
        );
    }
}
