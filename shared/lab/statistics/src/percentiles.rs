//! Nearest-rank percentiles.

use serde::Serialize;

/// Median and 99th percentile of a sample.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Percentiles {
    /// Median (50th percentile) of the values.
    pub p50: f64,
    /// 99th percentile of the values.
    pub p99: f64,
}

impl Percentiles {
    /// Percentiles of a sample in any order, in its own unit; `None` for an empty sample.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        Some(Self {
            p50: nearest_rank(&values, 0.5)?,
            p99: nearest_rank(&values, 0.99)?,
        })
    }
}

/// Nearest-rank percentile of a sample in ascending order: the smallest value that at least
/// `share` (0 to 1) of the values do not exceed. `None` for an empty sample.
pub fn nearest_rank<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_by_nearest_rank() {
        let of = |n: u32| Percentiles::of((1..=n).rev().map(f64::from).collect());
        for (n, p50, p99) in [
            (1, 1.0, 1.0),
            (2, 1.0, 2.0),
            (4, 2.0, 4.0),
            (200, 100.0, 198.0),
        ] {
            assert_eq!(of(n), Some(Percentiles { p50, p99 }), "{n} values");
        }
        assert_eq!(of(0), None);
    }
}
