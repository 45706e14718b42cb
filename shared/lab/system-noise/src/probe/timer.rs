//! Timer latency probe (after cyclictest, Gleixner and Williams).

use crate::samples::Samples;
use rustix::thread::{ClockId, Timespec, clock_nanosleep_absolute};
use service::monotonic_ns;
use std::time::Duration;

/// Timer period, ns.
const PERIOD_NS: u64 = 1_000_000;

/// Measures the overshoot of sleeps until absolute times of the monotonic clock, 1 ms apart, for
/// about `duration`. Periods missed by oversleeping are skipped.
pub fn timer_latency(duration: Duration) -> Samples {
    let end_ns = monotonic_ns() + duration.as_nanos() as u64;
    let n_most = duration.as_nanos() as u64 / PERIOD_NS + 1;
    let mut late_ns = Vec::with_capacity(n_most as usize);
    let mut due_ns = monotonic_ns() + PERIOD_NS;
    while due_ns <= end_ns {
        // After a signal the clock is before the deadline; sleep again.
        let slept = clock_nanosleep_absolute(ClockId::Monotonic, &timespec(due_ns));
        let now_ns = monotonic_ns();
        if slept.is_err() && now_ns < due_ns {
            continue;
        }
        late_ns.push(now_ns.saturating_sub(due_ns));
        due_ns += PERIOD_NS * (now_ns.saturating_sub(due_ns) / PERIOD_NS + 1);
    }
    Samples::new(
        "timer",
        "how late a thread wakes that sleeps until an instant, every 1 ms (clock_nanosleep)",
        late_ns,
    )
}

fn timespec(time_ns: u64) -> Timespec {
    Timespec {
        tv_sec: (time_ns / 1_000_000_000) as i64,
        tv_nsec: (time_ns % 1_000_000_000) as i64,
    }
}
