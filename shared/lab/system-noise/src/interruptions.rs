//! Interruptions of a spinning thread, measured by `oslat`.

use crate::measuring_program::{Error, MeasuringProgram};
use crate::privilege::usable_cores;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Minimum gap between two clock readings that counts as an interruption, µs. Chosen.
const GAP_MIN_US: u64 = 5;
/// Gaps from this one on are counted as this one, µs: most that the program allows.
const HISTOGRAM_US: u64 = 1024;

/// Gaps in the time of a thread that never sleeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interruptions {
    /// Number of gaps of 5 µs and more.
    pub n_gaps: u64,
    /// Observation time, seconds.
    pub watched_s: f64,
    /// Share of the observation time in these gaps, 0 to 1.
    pub share: f64,
    /// Longest interruption gap, µs.
    pub longest_us: u64,
    /// Number of gaps by duration, µs; those of 1 ms and more count as 1024 µs.
    pub counts: BTreeMap<u64, u64>,
}

impl Interruptions {
    /// Watches the last core for `duration_s`.
    pub(crate) fn measure(duration_s: u32) -> Result<Self, Error> {
        let last_core = usable_cores().and_then(|cores| cores.last().copied());
        let arguments = [
            "--quiet".to_owned(),
            format!("--cpu-list={}", last_core.unwrap_or(0)),
            format!("--duration={duration_s}"),
            format!("--bucket-size={HISTOGRAM_US}"),
        ];
        MeasuringProgram::OSLAT
            .first_thread(&arguments)
            .map(Self::of)
    }

    fn of(thread: OslatThread) -> Self {
        let mut counts = thread.histogram;
        counts.retain(|gap_us, _| *gap_us >= GAP_MIN_US);
        let taken_us: u64 = counts.iter().map(|(gap_us, n)| gap_us * n).sum();
        Self {
            n_gaps: counts.values().sum(),
            watched_s: thread.duration,
            share: (taken_us as f64 / 1e6 / thread.duration).clamp(0.0, 1.0),
            longest_us: thread.max,
            counts,
        }
    }
}

#[derive(Debug, Deserialize)]
struct OslatThread {
    histogram: BTreeMap<u64, u64>,
    max: u64,
    duration: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gaps_are_no_interruptions() {
        let found = Interruptions::of(OslatThread {
            histogram: [(1, 900_000), (4, 10), (5, 20), (100, 2)].into(),
            max: 107,
            duration: 2.0,
        });
        assert_eq!((found.n_gaps, found.longest_us), (22, 107));
        assert!((found.share - 150e-6).abs() < 1e-12);
    }
}
