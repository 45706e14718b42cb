//! What this process may do.

use crate::fingerprint::Limit;
use crate::scheduling::{FIFO_PRIORITY, RealTime};
use rustix::process::{Resource, Rlimit, getrlimit};
use rustix::thread::{CapabilitySet, capabilities};

/// Highest real-time priority that needs no privilege.
pub(crate) fn realtime_priority_limit() -> Limit {
    limit(getrlimit(Resource::Rtprio))
}

/// Bytes that may be locked without privilege.
pub(crate) fn locked_memory_limit() -> Limit {
    limit(getrlimit(Resource::Memlock))
}

fn limit(limit: Rlimit) -> Limit {
    limit.current.map_or(Limit::Unlimited, Limit::Most)
}

/// Whether a thread of this process gets `SCHED_FIFO`; tried by one that ends at
/// once. `None` when no thread could be started.
pub(crate) fn may_use_fifo() -> Option<bool> {
    let trial = || RealTime::begin(FIFO_PRIORITY).is_ok();
    let thread = std::thread::Builder::new().spawn(trial).ok()?;
    thread.join().ok()
}

/// Whether all of the memory may be locked, also what is allocated later: with a
/// limit in the way, an allocation would fail in the middle of the measurement.
pub(crate) fn may_lock_memory() -> bool {
    let is_capable =
        capabilities(None).is_ok_and(|sets| sets.effective.contains(CapabilitySet::IPC_LOCK));
    is_capable || locked_memory_limit() == Limit::Unlimited
}
