//! The clocks.

use rustix::time::{ClockId, clock_gettime};

/// The machine's monotonic clock, nanoseconds; the same in all processes.
pub fn monotonic_ns() -> u64 {
    now_ns(ClockId::Monotonic) as u64
}

/// The wall clock, nanoseconds since 1970.
pub fn wall_clock_ns() -> i64 {
    now_ns(ClockId::Realtime)
}

/// Wall clock minus monotonic clock, nanoseconds, now.
pub fn wall_clock_offset_ns() -> i64 {
    now_ns(ClockId::Realtime) - now_ns(ClockId::Monotonic)
}

fn now_ns(clock: ClockId) -> i64 {
    let now = clock_gettime(clock);
    now.tv_sec * 1_000_000_000 + now.tv_nsec
}
