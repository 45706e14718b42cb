//! Latency samples of a probe and their percentiles.

use serde::{Deserialize, Serialize};
use statistics::percentiles::nearest_rank;

/// Latency samples of one probe.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Samples {
    /// Name of the latency probe.
    pub name: String,
    /// Meaning of a value: the measured time.
    pub meaning: String,
    /// Sampled latencies in order of measurement, ns.
    pub values_ns: Vec<u64>,
    /// Percentiles of the samples; `None` without samples.
    pub summary: Option<LatencySummary>,
}

impl Samples {
    /// Latency samples with their computed percentiles.
    pub fn new(name: &str, meaning: &str, values_ns: Vec<u64>) -> Self {
        Self {
            name: name.to_owned(),
            meaning: meaning.to_owned(),
            summary: LatencySummary::of(&values_ns),
            values_ns,
        }
    }
}

/// Nearest-rank percentiles of latencies, ns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct LatencySummary {
    /// Number of samples.
    pub n: usize,
    /// Median latency, ns.
    pub p50_ns: u64,
    /// 90th percentile of the latencies, ns.
    pub p90_ns: u64,
    /// 99th percentile of the latencies, ns.
    pub p99_ns: u64,
    /// 99.9th percentile of the latencies, ns.
    pub p99_9_ns: u64,
    /// Maximum latency, ns.
    pub max_ns: u64,
}

impl LatencySummary {
    /// Percentiles of values in any order; `None` without values.
    pub fn of(values_ns: &[u64]) -> Option<Self> {
        let mut sorted = values_ns.to_vec();
        sorted.sort_unstable();
        Some(Self {
            n: sorted.len(),
            p50_ns: nearest_rank(&sorted, 0.5)?,
            p90_ns: nearest_rank(&sorted, 0.9)?,
            p99_ns: nearest_rank(&sorted, 0.99)?,
            p99_9_ns: nearest_rank(&sorted, 0.999)?,
            max_ns: *sorted.last()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn percentiles_are_values_by_nearest_rank() {
        let values: Vec<u64> = (1..=1000).rev().collect();
        let summary = LatencySummary::of(&values).unwrap();
        assert_eq!(
            (summary.n, summary.p50_ns, summary.p90_ns),
            (1000, 500, 900)
        );
        assert_eq!(
            (summary.p99_ns, summary.p99_9_ns, summary.max_ns),
            (990, 999, 1000)
        );
        assert_eq!(LatencySummary::of(&[]), None);
    }

    proptest! {
        #[test]
        fn percentiles_are_monotonic(values in prop::collection::vec(any::<u64>(), 1..300)) {
            let s = LatencySummary::of(&values).unwrap();
            let percentiles = [s.p50_ns, s.p90_ns, s.p99_ns, s.p99_9_ns, s.max_ns];
            prop_assert!(percentiles.is_sorted());
            prop_assert!(percentiles.iter().all(|value| values.contains(value)));
            let n_not_longer = values.iter().filter(|value| **value <= s.p50_ns).count();
            prop_assert!(2 * n_not_longer >= values.len());
        }
    }
}
