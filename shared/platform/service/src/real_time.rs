//! Real-time priority of a thread (`SCHED_FIFO`).
#![expect(unsafe_code, reason = "rustix does not wrap sched_setscheduler")]

use std::io;

/// Priority of a control loop among real-time threads, 1 to 99. Chosen: below the kernel's own
/// threads for interrupts, which have 50.
const PRIORITY: i32 = 20;

/// Gives the calling thread real-time priority, so that it runs as soon as it is due, whatever else
/// the processors do. Returns the priority.
///
/// # Errors
/// That of the system; without root the limit `RLIMIT_RTPRIO` must allow it. The thread keeps its
/// priority then.
pub fn set_real_time_priority() -> io::Result<i32> {
    let parameters = libc::sched_param {
        sched_priority: PRIORITY,
    };
    // A thread that this one starts does not inherit the priority.
    let policy = libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK;
    // SAFETY: the pointer is to a whole structure that outlives the call; thread 0 is this one.
    let outcome = unsafe { libc::sched_setscheduler(0, policy, &raw const parameters) };
    if outcome == 0 {
        Ok(PRIORITY)
    } else {
        Err(io::Error::last_os_error())
    }
}
