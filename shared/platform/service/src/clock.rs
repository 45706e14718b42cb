//! Monotonic clock and wall clock.

use rustix::time::{ClockId, clock_gettime};

/// Monotonic clock, nanoseconds; the same in all processes.
pub fn monotonic_ns() -> u64 {
    now_ns(ClockId::Monotonic) as u64
}

/// Wall clock time, nanoseconds since 1970.
pub fn wall_clock_ns() -> i64 {
    now_ns(ClockId::Realtime)
}

/// Current offset of the wall clock from the monotonic clock, nanoseconds.
pub fn wall_clock_offset_ns() -> i64 {
    now_ns(ClockId::Realtime) - now_ns(ClockId::Monotonic)
}

fn now_ns(clock: ClockId) -> i64 {
    let now = clock_gettime(clock);
    now.tv_sec * 1_000_000_000 + now.tv_nsec
}
