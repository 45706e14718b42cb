//! Privileges of this process: real-time priority and locked memory.

use crate::scheduling::{FIFO_PRIORITY, RealTimeGuard};
use rustix::process::{Resource, Rlimit, getrlimit};
use rustix::thread::{CapabilitySet, capabilities};
use serde::{Deserialize, Serialize};

/// Resource limit of this process (`getrlimit`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResourceLimit {
    /// Unlimited resource.
    Unlimited,
    /// Soft limit (current limit) of the resource.
    Most(u64),
}

/// Maximum real-time priority without privileges (`RLIMIT_RTPRIO`).
pub(crate) fn realtime_priority_limit() -> ResourceLimit {
    limit(getrlimit(Resource::Rtprio))
}

/// Maximum unprivileged locked memory, bytes.
pub(crate) fn locked_memory_limit() -> ResourceLimit {
    limit(getrlimit(Resource::Memlock))
}

fn limit(limit: Rlimit) -> ResourceLimit {
    limit
        .current
        .map_or(ResourceLimit::Unlimited, ResourceLimit::Most)
}

/// `true` if a thread of this process may use `SCHED_FIFO`, tried in a short-lived thread. `None`
/// if no thread could be started.
pub(crate) fn may_use_fifo() -> Option<bool> {
    let trial = || RealTimeGuard::begin(FIFO_PRIORITY).is_ok();
    let thread = std::thread::Builder::new().spawn(trial).ok()?;
    thread.join().ok()
}

/// `true` if all current and future memory may be locked. With a limit, a later allocation would
/// fail during the measurement.
pub(crate) fn may_lock_memory() -> bool {
    let is_capable =
        capabilities(None).is_ok_and(|sets| sets.effective.contains(CapabilitySet::IPC_LOCK));
    is_capable || locked_memory_limit() == ResourceLimit::Unlimited
}
