//! Scope guards of real-time settings, each reverted on drop.

use crate::system_call::{Scheduling, scheduling, set_scheduling};
use crate::system_files::SystemFiles;
use rustix::mm::{MlockAllFlags, mlockall, munlockall};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use rustix::thread::{current_timer_slack, set_current_timer_slack};
use std::io;
use std::marker::PhantomData;
use std::num::NonZeroU64;

/// Real-time priority of the trials: below the kernel's own threads at 99 and 90.
pub(crate) const FIFO_PRIORITY: i32 = 80;

/// Marker of a guard that must be dropped by the thread that created it.
type OfThisThread = PhantomData<*const ()>;

/// Runs the calling thread under `SCHED_FIFO`; drop restores its policy.
#[derive(Debug)]
pub(crate) struct RealTimeGuard {
    before: Scheduling,
    _thread: OfThisThread,
}

impl RealTimeGuard {
    pub(crate) fn begin(priority: i32) -> io::Result<Self> {
        let before = scheduling()?;
        set_scheduling(Scheduling::fifo(priority))?;
        Ok(Self {
            before,
            _thread: PhantomData,
        })
    }
}

impl Drop for RealTimeGuard {
    fn drop(&mut self) {
        // Returning to the previous policy is always permitted.
        let _ = set_scheduling(self.before);
    }
}

/// Pins the calling thread to one core; drop restores its affinity.
#[derive(Debug)]
pub(crate) struct AffinityGuard {
    before: CpuSet,
    _thread: OfThisThread,
}

impl AffinityGuard {
    pub(crate) fn begin(core: u32) -> io::Result<Self> {
        let before = sched_getaffinity(None)?;
        let mut only = CpuSet::new();
        only.set(core as usize);
        sched_setaffinity(None, &only)?;
        Ok(Self {
            before,
            _thread: PhantomData,
        })
    }
}

impl Drop for AffinityGuard {
    fn drop(&mut self) {
        let _ = sched_setaffinity(None, &self.before);
    }
}

/// Minimises the timer slack of the calling thread, so that its timers are not coalesced; drop
/// restores the slack.
#[derive(Debug)]
pub(crate) struct TimerSlackGuard {
    before_ns: u64,
    _thread: OfThisThread,
}

impl TimerSlackGuard {
    pub(crate) fn begin() -> io::Result<Self> {
        let before_ns = current_timer_slack()?;
        set_current_timer_slack(Some(NonZeroU64::MIN))?;
        Ok(Self {
            before_ns,
            _thread: PhantomData,
        })
    }
}

impl Drop for TimerSlackGuard {
    fn drop(&mut self) {
        // Real-time threads have a slack of 0, which cannot be set.
        let _ = set_current_timer_slack(NonZeroU64::new(self.before_ns));
    }
}

/// Timer slack of the calling thread, ns.
pub(crate) fn timer_slack_ns() -> Option<u64> {
    current_timer_slack().ok()
}

/// Locks all memory of the process into RAM; drop unlocks it.
#[derive(Debug)]
pub(crate) struct MemoryLockGuard(());

impl MemoryLockGuard {
    /// Locks all memory of the process. Fails if memory is already locked: unlocking affects the whole process and would revert
    /// locks of others.
    pub(crate) fn begin() -> io::Result<Self> {
        if locked_bytes() != Some(0) {
            return Err(io::Error::other("some memory is locked already"));
        }
        mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE)?;
        Ok(Self(()))
    }
}

impl Drop for MemoryLockGuard {
    fn drop(&mut self) {
        let _ = munlockall();
    }
}

/// Memory that this process has locked in RAM, bytes.
pub(crate) fn locked_bytes() -> Option<u64> {
    let status = SystemFiles::real().text("proc/self/status")?;
    crate::fingerprint::kernel_text::meminfo_bytes(&status, "VmLck")
}

/// Cores in the affinity mask of the calling thread.
pub(crate) fn usable_cores() -> Option<Vec<u32>> {
    let cores = sched_getaffinity(None).ok()?;
    let all = 0..CpuSet::MAX_CPU;
    Some(
        all.filter(|core| cores.is_set(*core))
            .map(|core| core as u32)
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn policy_and_priority_are_restored() {
        let before = scheduling().unwrap();
        if let Ok(guard) = RealTimeGuard::begin(FIFO_PRIORITY) {
            assert_eq!(scheduling().unwrap(), Scheduling::fifo(FIFO_PRIORITY));
            drop(guard);
        }
        assert_eq!(scheduling().unwrap(), before);
        assert!(RealTimeGuard::begin(1000).is_err());
        assert_eq!(scheduling().unwrap(), before);
    }

    #[test]
    fn affinity_is_restored() {
        let before = usable_cores().unwrap();
        let guard = AffinityGuard::begin(before[0]).unwrap();
        assert_eq!(usable_cores().unwrap(), before[..1]);
        drop(guard);
        assert_eq!(usable_cores().unwrap(), before);
        assert!(AffinityGuard::begin(CpuSet::MAX_CPU as u32 - 1).is_err() || before.len() > 1000);
        assert_eq!(usable_cores().unwrap(), before);
    }

    #[test]
    fn timer_slack_is_restored() {
        let before_ns = timer_slack_ns();
        let guard = TimerSlackGuard::begin().unwrap();
        assert_eq!(timer_slack_ns(), Some(1));
        drop(guard);
        assert_eq!(timer_slack_ns(), before_ns);
    }

    #[test]
    fn settings_are_restored_on_panic() {
        let before = (scheduling().unwrap(), usable_cores().unwrap());
        let core = before.1[0];
        let broken = std::panic::catch_unwind(|| {
            let _policy = RealTimeGuard::begin(FIFO_PRIORITY);
            let _core = AffinityGuard::begin(core);
            panic!("in the middle");
        });
        assert!(broken.is_err());
        assert_eq!((scheduling().unwrap(), usable_cores().unwrap()), before);
    }
}
