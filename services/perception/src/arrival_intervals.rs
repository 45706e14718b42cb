//! Inter-arrival times of frames: their running median, and the time after which a scene is
//! stale. Pure functions of passed-in times.

/// Number of recent intervals. Chosen: one long interval of them does not change the median.
const N_RECENT: usize = 8;
/// Shortest time without a frame that counts as a silence, nanoseconds. Chosen: a hung camera
/// shall be visible within about a second.
const SHORTEST_LIMIT_NS: u64 = 1_000_000_000;
/// Median intervals without a frame that count as a silence. Chosen.
const MISSED_FRAMES: u64 = 3;

/// Recent intervals between the receptions of frames.
#[derive(Debug, Default)]
pub(crate) struct ArrivalIntervals {
    last_ns: Option<u64>,
    recent_ns: [u64; N_RECENT],
    n_recorded: usize,
}

impl ArrivalIntervals {
    /// Records the reception of a frame, monotonic clock, nanoseconds.
    pub(crate) fn record(&mut self, received_ns: u64) {
        if let Some(last_ns) = self.last_ns.replace(received_ns) {
            self.recent_ns[self.n_recorded % N_RECENT] = received_ns.saturating_sub(last_ns);
            self.n_recorded += 1;
        }
    }

    /// Time since the last frame, nanoseconds; `None` before the first one.
    pub(crate) fn silence_ns(&self, now_ns: u64) -> Option<u64> {
        self.last_ns.map(|last_ns| now_ns.saturating_sub(last_ns))
    }

    /// Time after which a frame is missing, nanoseconds: a second, or a few frames of a slower
    /// source.
    pub(crate) fn stale_after_ns(&self) -> u64 {
        let mut recent_ns = self.recent_ns;
        let recent_ns = &mut recent_ns[..self.n_recorded.min(N_RECENT)];
        if recent_ns.is_empty() {
            return SHORTEST_LIMIT_NS;
        }
        let middle = recent_ns.len() / 2;
        let (_, &mut median_ns, _) = recent_ns.select_nth_unstable(middle);
        median_ns
            .saturating_mul(MISSED_FRAMES)
            .max(SHORTEST_LIMIT_NS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = 1_000_000_000;

    #[test]
    fn limit_follows_the_rate_of_a_slow_source() {
        let mut intervals = ArrivalIntervals::default();
        assert_eq!(intervals.silence_ns(5), None);
        assert_eq!(intervals.stale_after_ns(), SECOND);
        for frame in 0..20 {
            intervals.record(frame * SECOND / 30);
        }
        assert_eq!(intervals.stale_after_ns(), SECOND);
        for frame in 1..20 {
            intervals.record(frame * 10 * SECOND);
        }
        assert_eq!(intervals.stale_after_ns(), 30 * SECOND);
        assert_eq!(intervals.silence_ns(191 * SECOND), Some(SECOND));
    }

    #[test]
    fn outage_does_not_change_the_limit() {
        let mut intervals = ArrivalIntervals::default();
        let mut now_ns = 0;
        for frame in 0..100 {
            now_ns += if frame == 50 {
                60 * SECOND
            } else {
                SECOND / 10
            };
            intervals.record(now_ns);
            assert_eq!(intervals.stale_after_ns(), SECOND, "frame {frame}");
        }
    }
}
