//! The timer and wake-up probes under one setting.

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

/// What a thread can be given against noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Setting {
    /// Nothing: as every thread is.
    AsIs,
    /// `SCHED_FIFO` at priority 80.
    RealTime,
    /// One core, which it never leaves.
    OneCore,
    /// Timers that are not put off to be gathered with others.
    NoTimerSlack,
    /// All memory of the process locked into RAM.
    LockedMemory,
}

impl Setting {
    /// As a person says it.
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

/// What the probes measured under a setting.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trial {
    /// The setting.
    pub setting: Setting,
    /// Whether a thread was spinning on every core.
    pub is_loaded: bool,
    /// How late sleepers woke.
    pub timer: Samples,
    /// How long wake-ups took.
    pub wake_up: Samples,
}

/// Runs both probes under a setting, each for as long as is said. The setting
/// belongs to a thread that ends with the trial, and is taken back before.
///
/// # Errors
/// When this process may not have the setting, or a thread can not be started.
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

/// A setting that is taken back when this is dropped.
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

/// The first core gets most interrupts, so the last one is taken.
fn last_core() -> io::Result<u32> {
    let cores = usable_cores().unwrap_or_default();
    let last = cores.last().copied();
    last.ok_or_else(|| io::Error::other("the cores of this process are not told"))
}
