//! Frame schedule at a fixed rate.

/// Schedule at a fixed rate. Recorded frames are filled ahead and sent when they are
/// due, so that latency is counted from the scheduled time (no coordinated omission).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Schedule {
    start_ns: u64,
    period_ns: u64,
    n_released: u64,
}

/// Lag in periods above which a new schedule begins: a source that cannot keep the
/// rate must not send a burst when it recovers. Chosen.
const MAX_PERIODS_BEHIND: u64 = 5;

impl Schedule {
    /// Creates a schedule whose first frame is due at `start_ns`. `rate_hz` is
    /// positive.
    pub(crate) fn new(start_ns: u64, rate_hz: f64) -> Self {
        Self {
            start_ns,
            period_ns: (1e9 / rate_hz) as u64,
            n_released: 0,
        }
    }

    /// Scheduled time of the next frame, monotonic, nanoseconds.
    pub(crate) fn due_ns(&self) -> u64 {
        self.start_ns + self.n_released * self.period_ns
    }

    /// Begins anew, with the next frame due at `now_ns`: after an outage no frame is overdue.
    pub(crate) fn restart(&mut self, now_ns: u64) {
        self.start_ns = now_ns;
        self.n_released = 0;
    }

    /// Records the release of the next frame; `true` when it was more than a period
    /// late.
    pub(crate) fn release(&mut self, now_ns: u64) -> bool {
        let behind_ns = now_ns.saturating_sub(self.due_ns());
        self.n_released += 1;
        if behind_ns > MAX_PERIODS_BEHIND * self.period_ns {
            self.restart(now_ns + self.period_ns);
        }
        behind_ns > self.period_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_due_at_the_rate_and_lateness_is_reported() {
        let mut schedule = Schedule::new(1_000, 1e7);
        assert_eq!(schedule.due_ns(), 1_000);
        assert!(!schedule.release(1_090));
        assert_eq!(schedule.due_ns(), 1_100);
        assert!(schedule.release(1_250));
        assert_eq!(schedule.due_ns(), 1_200);
    }

    #[test]
    fn large_lag_causes_no_burst() {
        let mut schedule = Schedule::new(0, 1e7);
        assert!(schedule.release(10_000));
        assert_eq!(schedule.due_ns(), 10_100);
    }
}
