//! Frame schedule at a fixed rate, or at the intervals of a recording.

/// Schedule of frames. Recorded frames are filled ahead and sent when they are
/// due, so that latency is counted from the scheduled time (no coordinated omission).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Schedule {
    start_ns: u64,
    period_ns: u64,
    n_released: u64,
    /// Time of the next frame on the recording's own clock; `None` at a fixed rate.
    frame_time_ns: Option<u64>,
    /// Time of the frame that is due at the start, on the recording's own clock.
    origin_ns: Option<u64>,
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
            frame_time_ns: None,
            origin_ns: None,
        }
    }

    /// Sets the time of the next frame on the recording's own clock, from which it is due;
    /// `None` at a fixed rate.
    pub(crate) fn set_frame_time(&mut self, frame_time_ns: Option<u64>) {
        self.frame_time_ns = frame_time_ns;
        if self.origin_ns.is_none() {
            self.origin_ns = frame_time_ns;
        }
    }

    /// Scheduled time of the next frame, monotonic, nanoseconds.
    pub(crate) fn due_ns(&self) -> u64 {
        let since_start_ns = match (self.frame_time_ns, self.origin_ns) {
            (Some(frame_time_ns), Some(origin_ns)) => frame_time_ns.saturating_sub(origin_ns),
            _ => self.n_released * self.period_ns,
        };
        self.start_ns.saturating_add(since_start_ns)
    }

    /// Begins anew, with the next frame due at `now_ns`: after an outage no frame is overdue.
    pub(crate) fn restart(&mut self, now_ns: u64) {
        self.start_ns = now_ns;
        self.n_released = 0;
        self.origin_ns = None;
        self.frame_time_ns = None;
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
    fn frames_of_a_recording_are_due_at_its_intervals() {
        let mut schedule = Schedule::new(1_000, 1e7);
        let mut due = |time_ns, released_ns| {
            schedule.set_frame_time(Some(time_ns));
            let due_ns = schedule.due_ns();
            schedule.release(released_ns);
            due_ns
        };
        assert_eq!(due(70_000, 1_000), 1_000);
        assert_eq!(due(70_130, 1_130), 1_130);
        assert_eq!(due(70_190, 9_000), 1_190);
        // After a large lag the intervals go on from the next frame.
        assert_eq!(due(70_290, 9_100), 9_100);
        assert_eq!(due(70_300, 9_110), 9_110);
    }

    #[test]
    fn large_lag_causes_no_burst() {
        let mut schedule = Schedule::new(0, 1e7);
        assert!(schedule.release(10_000));
        assert_eq!(schedule.due_ns(), 10_100);
    }
}
