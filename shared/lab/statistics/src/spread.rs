//! Summary statistics of a sample: count, mean, percentiles, maximum.

use crate::percentiles::nearest_rank;
use serde::Serialize;

/// Count, mean, nearest-rank percentiles and maximum of a sample.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Number of values.
    pub n: usize,
    /// Arithmetic mean of the values.
    pub mean: f64,
    /// Median of the values.
    pub median: f64,
    /// 95th percentile of the values.
    pub p95: f64,
    /// 99th percentile of the values.
    pub p99: f64,
    /// Maximum of the values.
    pub max: f64,
}

impl Spread {
    /// Summary of a sample in any order; `None` for an empty sample.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut values = values.to_vec();
        values.sort_unstable_by(f64::total_cmp);
        let n = values.len();
        let at = |share| nearest_rank(&values, share);
        Some(Self {
            n,
            mean: values.iter().sum::<f64>() / n.max(1) as f64,
            median: at(0.5)?,
            p95: at(0.95)?,
            p99: at(0.99)?,
            max: at(1.0)?,
        })
    }
}

/// Sample mean and standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanAndStd {
    /// Arithmetic mean over the runs.
    pub mean: f64,
    /// Sample standard deviation (n - 1); `None` for a single value.
    pub std: Option<f64>,
}

impl MeanAndStd {
    /// Mean and standard deviation of a sample; `None` for no values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (!values.is_empty()).then(|| Self {
            mean,
            std: (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_by_nearest_rank() {
        let values: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        let expected = Spread {
            n: 200,
            mean: 100.5,
            median: 100.0,
            p95: 190.0,
            p99: 198.0,
            max: 200.0,
        };
        assert_eq!(Spread::of(&values), Some(expected));
        assert_eq!(Spread::of(&[]), None);
    }
}
