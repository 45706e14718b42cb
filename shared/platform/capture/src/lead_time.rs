//! Lead time: running quantile of the time to make a frame, plus a reserve.

/// Length of the window of recent frames. Chosen.
const N_RECENT: usize = 64;
/// Least number of frames for an estimate; before, frames are begun at once. Chosen.
const N_KNOWN_MIN: usize = 8;
/// Quantile of the recent times to make a frame. Chosen.
const SHARE_IN_TIME: f64 = 0.9;
/// Relative reserve for load by other programs. Chosen.
const RESERVE_SHARE: f64 = 0.25;
const RESERVE_NS: u64 = 2_000_000;

/// Estimator of the time to make a frame, so that each can be begun as late as is
/// safe.
///
/// Making a frame takes a core. A source that begins right after sending the last
/// frame takes it from the processes that have just received that frame: a woken
/// thread is put on the core of the thread that wakes it, and two cores of one chip
/// are slower together.
#[derive(Debug)]
pub(crate) struct LeadTime {
    recent_ns: [u64; N_RECENT],
    n_recorded: usize,
}

impl LeadTime {
    /// Lead-time estimator without observations.
    pub(crate) const UNKNOWN: Self = Self {
        recent_ns: [0; N_RECENT],
        n_recorded: 0,
    };

    /// Records the time that a frame took to make, nanoseconds.
    pub(crate) fn record(&mut self, ns: u64) {
        self.recent_ns[self.n_recorded % N_RECENT] = ns;
        self.n_recorded += 1;
    }

    /// Lead time of the next frame before its scheduled time, nanoseconds; `None`
    /// with too few observations.
    pub(crate) fn lead_ns(&self) -> Option<u64> {
        if self.n_recorded < N_KNOWN_MIN {
            return None;
        }
        let mut known = self.recent_ns;
        let known = &mut known[..self.n_recorded.min(N_RECENT)];
        let rank = (SHARE_IN_TIME * known.len() as f64) as usize;
        let (_, usual_ns, _) = known.select_nth_unstable(rank.min(known.len() - 1));
        let reserve_ns = (RESERVE_SHARE * *usual_ns as f64) as u64 + RESERVE_NS;
        Some(*usual_ns + reserve_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lead_time_follows_recent_frames() {
        let mut lead = LeadTime::UNKNOWN;
        for _ in 0..N_KNOWN_MIN {
            assert_eq!(lead.lead_ns(), None);
            lead.record(8_000_000);
        }
        assert_eq!(lead.lead_ns(), Some(12_000_000));
        for _ in 0..N_RECENT {
            lead.record(4_000_000);
        }
        assert_eq!(lead.lead_ns(), Some(7_000_000));
    }

    #[test]
    fn lead_time_ignores_single_slow_frames() {
        let mut lead = LeadTime::UNKNOWN;
        for frame in 0..N_RECENT {
            lead.record(if frame % 20 == 0 {
                30_000_000
            } else {
                4_000_000
            });
        }
        assert_eq!(lead.lead_ns(), Some(7_000_000));
        for frame in 0..N_RECENT {
            lead.record(if frame % 5 == 0 {
                30_000_000
            } else {
                4_000_000
            });
        }
        assert_eq!(lead.lead_ns(), Some(39_500_000));
    }
}
