//! Batch means: percentiles of consecutive parts of a run, for confidence intervals on correlated
//! samples.

use crate::duration_percentiles::DurationPercentiles;
use serde::{Deserialize, Serialize};

/// Number of batches of a run. Chosen.
pub(crate) const N_BATCHES: usize = 20;

/// Duration and the index of its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sample {
    pub(crate) frame: u32,
    pub(crate) ns: u64,
}

/// Percentiles of one batch of a run, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// Median (50th percentile) of the batch.
    pub p50: f64,
    /// 90th percentile of the batch.
    pub p90: f64,
    /// 99th percentile of the batch.
    pub p99: f64,
}

/// Name of a percentile and its accessor.
type Named = (&'static str, fn(&Batch) -> f64);

impl Batch {
    /// Percentiles of a batch with their names.
    pub(crate) const NAMED: [Named; 3] = [
        ("p50", |batch| batch.p50),
        ("p90", |batch| batch.p90),
        ("p99", |batch| batch.p99),
    ];
}

/// Percentiles of [`N_BATCHES`] consecutive batches of equally many frames; batches without
/// samples are left out.
pub(crate) fn batch_percentiles(samples: &[Sample], n_frames: usize) -> Vec<Batch> {
    let mut parts = vec![Vec::new(); N_BATCHES];
    for sample in samples {
        let part = sample.frame as usize * N_BATCHES / n_frames.max(1);
        if let Some(part) = parts.get_mut(part) {
            part.push(sample.ns);
        }
    }
    parts
        .iter_mut()
        .filter(|part| !part.is_empty())
        .map(|part| {
            let DurationPercentiles { p50, p90, p99, .. } = DurationPercentiles::of(part);
            Batch { p50, p90, p99 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_hold_equally_many_frames() {
        let sample = |frame: u32| Sample {
            frame,
            ns: u64::from(frame / 5) * 1_000_000,
        };
        let samples: Vec<_> = (0..100).map(sample).collect();
        let parts = batch_percentiles(&samples, 100);
        assert_eq!(parts.len(), N_BATCHES);
        for (i, part) in parts.iter().enumerate() {
            assert_eq!(part.p50, i as f64);
        }
        assert!(batch_percentiles(&[], 100).is_empty());
    }
}
