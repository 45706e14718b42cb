//! Cost of reading a clock.

use crate::samples::Samples;
use crate::system_call::read_thread_usage;
use rustix::time::{ClockId, clock_gettime};
use serde::{Deserialize, Serialize};
use service::monotonic_ns;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Readings per timed batch: a single reading is as short as the clock's resolution.
const BATCH: u64 = 100;
/// Maximum number of batches per clock.
const BATCHES_MAX: usize = 2_000;

/// Cost of reading one clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClockCost {
    /// Name of the clock's system call.
    pub clock: String,
    /// Cost of one reading in the median batch, ns.
    pub reading_ns: f64,
    /// Duration of each batch of 100 readings, ns.
    pub batches: Samples,
}

/// Measures each clock used for tabula's latencies, for `duration` each.
pub fn clock_costs(duration: Duration) -> Vec<ClockCost> {
    vec![
        cost("CLOCK_MONOTONIC", duration, || {
            black_box(clock_gettime(ClockId::Monotonic));
        }),
        cost("CLOCK_THREAD_CPUTIME_ID", duration, || {
            black_box(clock_gettime(ClockId::ThreadCPUTime));
        }),
        cost("getrusage(RUSAGE_THREAD)", duration, || {
            let _ = black_box(read_thread_usage());
        }),
    ]
}

fn cost(clock: &str, duration: Duration, read: impl Fn()) -> ClockCost {
    let end = Instant::now() + duration;
    let mut batches_ns = Vec::with_capacity(BATCHES_MAX);
    while batches_ns.len() < BATCHES_MAX && (batches_ns.is_empty() || Instant::now() < end) {
        let start_ns = monotonic_ns();
        (0..BATCH).for_each(|_| read());
        batches_ns.push(monotonic_ns() - start_ns);
    }
    let batches = Samples::new(
        clock,
        "100 readings of the clock, one after the other",
        batches_ns,
    );
    ClockCost {
        clock: clock.to_owned(),
        reading_ns: batches
            .summary
            .map_or(0.0, |s| s.p50_ns as f64 / BATCH as f64),
        batches,
    }
}
