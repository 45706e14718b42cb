//! Timer latency under real-time settings, measured by `cyclictest`.

use crate::measuring_program::{Error, MeasuringProgram};
use crate::privilege::usable_cores;
use rustix::process::{Pid, Signal, kill_process};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::process::Child;

/// Latencies from this one on are counted without their value, µs.
const HISTOGRAM_US: u64 = 100_000;

coded_enum::coded_enum! {
    /// Setting of the measured thread.
    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum ThreadSetting {
        /// Baseline: default scheduling.
        #[serde(rename = "as-is")]
        Baseline, "as it is";
        /// `SCHED_FIFO` at priority 80: below the kernel's own threads at 99 and 90.
        RealTime, "SCHED_FIFO 80";
        /// CPU affinity of one core.
        OneCore, "on one core";
        /// All memory of the process locked into RAM.
        LockedMemory, "memory locked";
    }
}

impl ThreadSetting {
    /// Arguments of `cyclictest`. The last core is taken: the first one handles most interrupts.
    fn arguments(self) -> Vec<String> {
        let last_core = usable_cores().and_then(|cores| cores.last().copied());
        match self {
            Self::Baseline => vec!["--policy=other".to_owned()],
            Self::RealTime => vec!["--priority=80".to_owned()],
            Self::OneCore => vec![
                "--policy=other".to_owned(),
                format!("--affinity={}", last_core.unwrap_or(0)),
            ],
            Self::LockedMemory => vec!["--policy=other".to_owned(), "--mlockall".to_owned()],
        }
    }
}

/// Timer latencies under one setting.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TimerTrial {
    /// Thread setting of the trial.
    pub setting: ThreadSetting,
    /// `true` if a thread was computing on every core.
    pub is_loaded: bool,
    /// Number of timers.
    pub n: u64,
    /// Maximum latency, µs.
    pub max_us: u64,
    /// Number of timers by latency, µs; those of 0.1 s and more are left out.
    pub counts: BTreeMap<u64, u64>,
}

impl TimerTrial {
    /// Measures the overshoot of `n_timers` sleeps of 1 ms.
    pub(crate) fn measure(
        setting: ThreadSetting,
        is_loaded: bool,
        n_timers: u32,
    ) -> Result<Self, Error> {
        let mut arguments = setting.arguments();
        arguments.extend([
            "--quiet".to_owned(),
            "--default-system".to_owned(),
            "--threads=1".to_owned(),
            "--interval=1000".to_owned(),
            format!("--loops={n_timers}"),
            format!("--histogram={HISTOGRAM_US}"),
        ]);
        let thread: CyclictestThread = MeasuringProgram::CYCLICTEST.first_thread(&arguments)?;
        Ok(Self {
            setting,
            is_loaded,
            n: thread.cycles,
            max_us: thread.max,
            counts: thread.histogram,
        })
    }

    /// Latency by nearest rank, µs; `share` is 0 to 1.
    pub fn percentile_us(&self, share: f64) -> u64 {
        let rank = (share * self.n as f64).ceil().max(1.0) as u64;
        let mut n_below = 0;
        let mut counts = self.counts.iter();
        let found = counts.find(|(_, count)| {
            n_below += **count;
            n_below >= rank
        });
        found.map_or(self.max_us, |(latency_us, _)| *latency_us)
    }
}

#[derive(Debug, Deserialize)]
struct CyclictestThread {
    histogram: BTreeMap<u64, u64>,
    cycles: u64,
    max: u64,
}

/// Load of `stress-ng` on every core, ended on drop.
#[derive(Debug)]
pub(crate) struct CpuLoad(Child);

impl CpuLoad {
    pub(crate) fn begin(n_cores: usize) -> Result<Self, Error> {
        let arguments = ["--cpu".to_owned(), n_cores.to_string()];
        MeasuringProgram::STRESS_NG.start(&arguments).map(Self)
    }
}

impl Drop for CpuLoad {
    fn drop(&mut self) {
        // Its processes end with it only if it may end by itself.
        let _ = kill_process(Pid::from_child(&self.0), Signal::TERM);
        let _ = self.0.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_latencies_by_nearest_rank() {
        let trial = TimerTrial {
            setting: ThreadSetting::Baseline,
            is_loaded: false,
            n: 1000,
            max_us: 200_000,
            counts: [(3, 500), (5, 490), (9, 9)].into(),
        };
        let found = [0.0, 0.5, 0.501, 0.99, 0.999, 1.0].map(|share| trial.percentile_us(share));
        assert_eq!(found, [3, 3, 5, 5, 9, 200_000]);
    }
}
