//! Privileges of this process: cores, timer slack, real-time priority and locked memory.

use rustix::process::{Resource, Rlimit, getrlimit};
use rustix::thread::{CpuSet, current_timer_slack, sched_getaffinity};
use serde::{Deserialize, Serialize};
use std::process::{Command, Stdio};

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

/// `true` if a process with these privileges may use `SCHED_FIFO` at priority 80, tried by
/// `chrt`. `None` if it could not be started.
pub(crate) fn may_use_fifo() -> Option<bool> {
    let mut trial = Command::new("chrt");
    let trial = trial.args(["--fifo", "80", "true"]);
    let status = trial.stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.ok().map(|status| status.success())
}

/// Timer slack of the calling thread, ns.
pub(crate) fn timer_slack_ns() -> Option<u64> {
    current_timer_slack().ok()
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
