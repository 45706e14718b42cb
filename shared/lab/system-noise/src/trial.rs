//! Thread settings against noise, and trials of the timer and wake-up probes under them.

use crate::noise::load::Load;
use crate::noise::timer::timer;
use crate::noise::wake_up::wake_up;
use crate::privilege::may_lock_memory;
use crate::samples::Samples;
use crate::scheduling::{
    FIFO_PRIORITY, LockedMemory, NoTimerSlack, OneCore, RealTime, usable_cores,
};
use serde::{Deserialize, Serialize};
use std::io;
use std::time::Duration;

/// Setting of the probing threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Setting {
    /// Baseline: default scheduling.
    AsIs,
    /// `SCHED_FIFO` at priority 80.
    RealTime,
    /// CPU affinity of one core.
    OneCore,
    /// Minimal timer slack: timers are not coalesced.
    NoTimerSlack,
    /// All memory of the process locked into RAM.
    LockedMemory,
}

impl Setting {
    /// Name for text reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsIs => "as it is",
            Self::RealTime => "SCHED_FIFO 80",
            Self::OneCore => "on one core",
            Self::NoTimerSlack => "no timer slack",
            Self::LockedMemory => "memory locked",
        }
    }
}

/// Latencies of the probes under one setting.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trial {
    /// Setting.
    pub setting: Setting,
    /// `true` if a thread was spinning on every core.
    pub is_loaded: bool,
    /// Timer latencies.
    pub timer: Samples,
    /// Wake-up latencies.
    pub wake_up: Samples,
}

/// Runs both probes under a setting for `duration` each, in a thread of its own; the setting is
/// reverted before the thread ends.
///
/// # Errors
/// If this process is not permitted the setting, or a thread cannot be started.
pub fn trial(setting: Setting, is_loaded: bool, duration: Duration) -> io::Result<Trial> {
    let n_cores = usable_cores().map_or(1, |cores| cores.len());
    let _load = is_loaded.then(|| Load::begin(n_cores)).transpose()?;
    let probes = move || {
        let _applied = Applied::begin(setting)?;
        Ok::<_, io::Error>((timer(duration), wake_up(duration)?))
    };
    let thread = std::thread::Builder::new().spawn(probes)?;
    let measured = thread.join();
    let (timer, wake_up) =
        measured.map_err(|_| io::Error::other("the probing thread panicked"))??;
    Ok(Trial {
        setting,
        is_loaded,
        timer,
        wake_up,
    })
}

/// Applied setting, reverted on drop.
enum Applied {
    Nothing,
    RealTime { _guard: RealTime },
    OneCore { _guard: OneCore },
    NoTimerSlack { _guard: NoTimerSlack },
    LockedMemory { _guard: LockedMemory },
}

impl Applied {
    fn begin(setting: Setting) -> io::Result<Self> {
        Ok(match setting {
            Setting::AsIs => Self::Nothing,
            Setting::RealTime => Self::RealTime {
                _guard: RealTime::begin(FIFO_PRIORITY)?,
            },
            Setting::OneCore => Self::OneCore {
                _guard: OneCore::begin(last_core()?)?,
            },
            Setting::NoTimerSlack => Self::NoTimerSlack {
                _guard: NoTimerSlack::begin()?,
            },
            Setting::LockedMemory if !may_lock_memory() => {
                return Err(io::Error::from(io::ErrorKind::PermissionDenied));
            }
            Setting::LockedMemory => Self::LockedMemory {
                _guard: LockedMemory::begin()?,
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
