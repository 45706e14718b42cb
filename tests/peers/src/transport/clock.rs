//! Monotonic and processor-time clocks, in nanoseconds.

use rustix::time::{ClockId, Timespec, clock_gettime};
use std::time::Duration;

/// Reads a POSIX clock, nanoseconds.
fn read(clock: ClockId) -> u64 {
    let Timespec { tv_sec, tv_nsec } = clock_gettime(clock);
    tv_sec as u64 * 1_000_000_000 + tv_nsec as u64
}

/// Monotonic time, comparable between the processes of a machine, nanoseconds.
#[inline]
pub fn now_ns() -> u64 {
    read(ClockId::Monotonic)
}

/// Processor time of all threads of this process, nanoseconds.
pub fn process_ns() -> u64 {
    read(ClockId::ProcessCPUTime)
}

/// Processor time of this thread, nanoseconds.
pub fn thread_ns() -> u64 {
    read(ClockId::ThreadCPUTime)
}

/// Waits until a monotonic time; spins if `spins`, else sleeps.
pub fn wait_until(instant_ns: u64, spins: bool) {
    loop {
        let now_ns = now_ns();
        if now_ns >= instant_ns {
            return;
        }
        if spins {
            std::hint::spin_loop();
        } else {
            std::thread::sleep(Duration::from_nanos(instant_ns - now_ns));
        }
    }
}
