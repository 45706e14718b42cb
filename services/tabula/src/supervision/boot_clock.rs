//! Boot clock: time since boot, which goes on while the machine is suspended.

use super::progress_watch::BootTime;
use rustix::time::{ClockId, clock_gettime};

/// Time since boot (`CLOCK_BOOTTIME`). Unlike the monotonic clock it shows a suspend as a gap.
pub(crate) fn time_since_boot() -> BootTime {
    let time = clock_gettime(ClockId::Boottime);
    BootTime::new(time.tv_sec.max(0) as u64, time.tv_nsec as u32)
}
