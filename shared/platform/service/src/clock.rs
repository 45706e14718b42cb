//! Monotonic clock and wall clock.

use rustix::time::{ClockId, clock_gettime};
use std::time::{SystemTime, UNIX_EPOCH};

/// Monotonic clock, nanoseconds; the same in all processes.
pub fn monotonic_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Wall clock time, nanoseconds since 1970. By the C library, where tests set another clock.
pub fn wall_clock_ns() -> i64 {
    match SystemTime::now().duration_since(UNIX_EPOCH) {
        Ok(since) => since.as_nanos() as i64,
        Err(before) => -(before.duration().as_nanos() as i64),
    }
}

/// Current offset of the wall clock from the monotonic clock, nanoseconds.
pub fn wall_clock_offset_ns() -> i64 {
    wall_clock_ns() - monotonic_ns() as i64
}
