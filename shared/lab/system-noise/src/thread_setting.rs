//! Thread settings against noise, and trials of the timer and wake-up probes under them.

use crate::privilege::may_lock_memory;
use crate::probe::cpu_load::CpuLoad;
use crate::probe::timer::timer_latency;
use crate::probe::wake_up::wake_up_latency;
use crate::samples::Samples;
use crate::scheduling::{
    AffinityGuard, FIFO_PRIORITY, MemoryLockGuard, RealTimeGuard, TimerSlackGuard, usable_cores,
};
use serde::{Deserialize, Serialize};
use std::io;
use std::time::Duration;

/// Setting of the probing threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ThreadSetting {
    /// Baseline: default scheduling.
    #[serde(rename = "as-is")]
    Baseline,
    /// `SCHED_FIFO` at priority 80.
    RealTime,
    /// CPU affinity of one core.
    OneCore,
    /// Minimal timer slack: timers are not coalesced.
    NoTimerSlack,
    /// All memory of the process locked into RAM.
    LockedMemory,
}

impl ThreadSetting {
    /// Name of the thread setting for text reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "as it is",
            Self::RealTime => "SCHED_FIFO 80",
            Self::OneCore => "on one core",
            Self::NoTimerSlack => "no timer slack",
            Self::LockedMemory => "memory locked",
        }
    }
}

/// Latencies of the probes under one setting.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SettingTrial {
    /// Thread setting of the trial.
    pub setting: ThreadSetting,
    /// `true` if a thread was spinning on every core.
    pub is_loaded: bool,
    /// Timer latencies under the setting.
    pub timer: Samples,
    /// Wake-up latencies under the setting.
    pub wake_up: Samples,
}

/// Runs both probes under a setting for `duration` each, in a thread of its own; the setting is
/// reverted before the thread ends.
///
/// # Errors
/// If this process is not permitted the setting, or a thread cannot be started.
pub fn run_trial(
    setting: ThreadSetting,
    is_loaded: bool,
    duration: Duration,
) -> io::Result<SettingTrial> {
    let n_cores = usable_cores().map_or(1, |cores| cores.len());
    let _load = is_loaded.then(|| CpuLoad::begin(n_cores)).transpose()?;
    let probes = move || {
        let _applied = AppliedSetting::begin(setting)?;
        Ok::<_, io::Error>((timer_latency(duration), wake_up_latency(duration)?))
    };
    let thread = std::thread::Builder::new().spawn(probes)?;
    let measured = thread.join();
    let (timer, wake_up) =
        measured.map_err(|_| io::Error::other("the probing thread panicked"))??;
    Ok(SettingTrial {
        setting,
        is_loaded,
        timer,
        wake_up,
    })
}

/// Thread setting that is applied, and reverted on drop.
enum AppliedSetting {
    Nothing,
    RealTime { _guard: RealTimeGuard },
    OneCore { _guard: AffinityGuard },
    NoTimerSlack { _guard: TimerSlackGuard },
    LockedMemory { _guard: MemoryLockGuard },
}

impl AppliedSetting {
    fn begin(setting: ThreadSetting) -> io::Result<Self> {
        Ok(match setting {
            ThreadSetting::Baseline => Self::Nothing,
            ThreadSetting::RealTime => Self::RealTime {
                _guard: RealTimeGuard::begin(FIFO_PRIORITY)?,
            },
            ThreadSetting::OneCore => Self::OneCore {
                _guard: AffinityGuard::begin(last_core()?)?,
            },
            ThreadSetting::NoTimerSlack => Self::NoTimerSlack {
                _guard: TimerSlackGuard::begin()?,
            },
            ThreadSetting::LockedMemory if !may_lock_memory() => {
                return Err(io::Error::from(io::ErrorKind::PermissionDenied));
            }
            ThreadSetting::LockedMemory => Self::LockedMemory {
                _guard: MemoryLockGuard::begin()?,
            },
        })
    }
}

/// Last usable core: the first one handles most interrupts.
fn last_core() -> io::Result<u32> {
    let cores = usable_cores().unwrap_or_default();
    let last = cores.last().copied();
    last.ok_or_else(|| io::Error::other("the cores of this process are not told"))
}
