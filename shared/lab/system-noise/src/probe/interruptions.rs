//! Interruptions of a spinning thread (after the kernel's osnoise tracer, Bristot de Oliveira
//! 2021).

use crate::samples::Samples;
use serde::{Deserialize, Serialize};
use service::monotonic_ns;
use std::time::Duration;

/// Minimum gap between two clock readings that counts as an interruption. Chosen.
const GAP_MIN_NS: u64 = 5_000;
/// Maximum number of individually recorded gaps.
const KEPT_MAX: usize = 50_000;

/// Gaps in the time of a spinning thread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interruptions {
    /// Length of each gap of more than 5 µs; at most the first 50,000.
    pub gaps: Samples,
    /// Total number of gaps.
    pub n_gaps: u64,
    /// Observation time, ns.
    pub watched_ns: u64,
    /// Share of the observation time lost to gaps, 0 to 1.
    pub share: f64,
    /// Longest interruption gap, ns; 0 without gaps.
    pub longest_ns: u64,
}

/// Reads the clock in a loop for `duration` and records the gaps.
pub fn interruptions(duration: Duration) -> Interruptions {
    let mut gaps_ns = Vec::with_capacity(KEPT_MAX);
    let (mut n_gaps, mut taken_ns, mut longest_ns) = (0, 0, 0);
    let start_ns = monotonic_ns();
    let end_ns = start_ns + duration.as_nanos() as u64;
    let mut last_ns = start_ns;
    while last_ns < end_ns {
        let now_ns = monotonic_ns();
        let gap_ns = now_ns.saturating_sub(last_ns);
        if gap_ns > GAP_MIN_NS {
            n_gaps += 1;
            taken_ns += gap_ns;
            longest_ns = gap_ns.max(longest_ns);
            if gaps_ns.len() < KEPT_MAX {
                gaps_ns.push(gap_ns);
            }
        }
        last_ns = now_ns;
    }
    let watched_ns = last_ns - start_ns;
    Interruptions {
        gaps: Samples::new(
            "interruptions",
            "gaps of more than 5 µs in the time of a thread that never sleeps",
            gaps_ns,
        ),
        n_gaps,
        watched_ns,
        share: taken_ns as f64 / watched_ns.max(1) as f64,
        longest_ns,
    }
}
