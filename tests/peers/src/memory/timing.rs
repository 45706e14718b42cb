//! What was measured of one system.

use std::time::Duration;

/// Changes made one after the other or by several callers.
pub struct Run {
    pub elapsed_ns: u64,
    /// Of each change that was timed.
    pub latencies_ns: Vec<u64>,
    /// A bare `fdatasync` just before.
    pub sync_ms: f64,
}

/// All labelled views loaded by a process of its own.
#[derive(Clone, Copy)]
pub struct Load {
    pub opening_ms: f64,
    /// With the opening.
    pub all_ms: f64,
    pub n_views: f64,
    pub memory_kb: f64,
    pub most_memory_kb: f64,
}

impl Run {
    pub fn new(elapsed: Duration, latencies_ns: Vec<u64>) -> Self {
        Self {
            elapsed_ns: elapsed.as_nanos() as u64,
            latencies_ns,
            sync_ms: f64::NAN,
        }
    }

    pub fn per_second(&self) -> f64 {
        self.latencies_ns.len() as f64 / (self.elapsed_ns as f64 * 1e-9)
    }

    /// Milliseconds that `share` of the changes do not exceed.
    pub fn latency_ms(&self, share: f64) -> f64 {
        quantile(self.latencies_ns.iter().map(|&ns| ns as f64 * 1e-6), share)
    }
}

impl Load {
    /// Reads the line that a process prints when it has loaded.
    pub fn parse(line: &str) -> Option<Self> {
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        let [opening_ms, all_ms, n_views, memory_kb, most_memory_kb] = numbers.ok()?[..] else {
            return None;
        };
        Some(Self {
            opening_ms,
            all_ms,
            n_views,
            memory_kb,
            most_memory_kb,
        })
    }
}

/// The value that `share` of all do not exceed.
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values[rank.clamp(1, values.len()) - 1]
}

pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}
