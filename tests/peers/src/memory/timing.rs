//! Timings of one store: latencies of mutations, and loading of a whole database.

use std::time::Duration;

/// Timing of a scenario's mutations.
pub struct MutationTiming {
    /// Time of the whole scenario, nanoseconds.
    pub elapsed_ns: u64,
    /// Latency of each timed mutation, nanoseconds.
    pub latencies_ns: Vec<u64>,
    /// Disk baseline: latency of a bare `fdatasync` just before the scenario, milliseconds.
    pub sync_ms: f64,
}

/// Timing and memory of a separate process that loads all labelled views.
#[derive(Clone, Copy)]
pub struct LoadTiming {
    /// Opening of the database, milliseconds.
    pub opening_ms: f64,
    /// Opening and loading, milliseconds.
    pub total_ms: f64,
    /// Number of loaded views.
    pub n_views: f64,
    /// Resident memory at the end (`VmRSS`), kilobytes.
    pub memory_kb: f64,
    /// Peak resident memory (`VmHWM`), kilobytes.
    pub peak_memory_kb: f64,
}

impl MutationTiming {
    /// Timing without a disk baseline; [`Self::sync_ms`] is NaN.
    pub fn new(elapsed: Duration, latencies_ns: Vec<u64>) -> Self {
        Self {
            elapsed_ns: elapsed.as_nanos() as u64,
            latencies_ns,
            sync_ms: f64::NAN,
        }
    }

    /// Throughput, mutations per second.
    pub fn per_second(&self) -> f64 {
        self.latencies_ns.len() as f64 / (self.elapsed_ns as f64 * 1e-9)
    }

    /// Quantile of the latency at `share` (0 to 1), milliseconds.
    pub fn latency_ms(&self, share: f64) -> f64 {
        quantile(self.latencies_ns.iter().map(|&ns| ns as f64 * 1e-6), share)
    }
}

impl LoadTiming {
    /// Parses the line of five numbers that a loading process prints.
    pub fn parse(line: &str) -> Option<Self> {
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        let [opening_ms, total_ms, n_views, memory_kb, peak_memory_kb] = numbers.ok()?[..] else {
            return None;
        };
        Some(Self {
            opening_ms,
            total_ms,
            n_views,
            memory_kb,
            peak_memory_kb,
        })
    }
}

/// Quantile by nearest rank: the smallest value that at least `share` (0 to 1) of all do not exceed.
///
/// # Panics
/// If there are no values.
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values[rank.clamp(1, values.len()) - 1]
}

/// Median by nearest rank (the lower one of an even number).
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}
