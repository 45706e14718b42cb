//! How long before its instant a frame is begun.

/// Frames over which the time is learned.
const N_RECENT: usize = 64;
/// Before so many are known, frames are begun at once.
const N_KNOWN_MIN: usize = 8;
/// Of the recent frames this share was made in time; more takes the lead.
const SHARE_IN_TIME: f64 = 0.9;
/// What is added to that: a share, and a time, for what a busy computer takes away.
const RESERVE_SHARE: f64 = 0.25;
const RESERVE_NS: u64 = 2_000_000;

/// Learns how long frames take to make, so that each can be begun as late as is safe.
///
/// Making a frame takes a core. Who begins right after sending the last one takes it
/// from those who have just got that: a thread that is waked is put on the core of
/// the one that wakes it, and two cores of one chip are slower together.
#[derive(Debug)]
pub(crate) struct LeadTime {
    recent_ns: [u64; N_RECENT],
    n_made: usize,
}

impl LeadTime {
    /// Nothing is known yet.
    pub(crate) const UNKNOWN: Self = Self {
        recent_ns: [0; N_RECENT],
        n_made: 0,
    };

    /// Notes how long a frame took to make.
    pub(crate) fn made_in(&mut self, ns: u64) {
        self.recent_ns[self.n_made % N_RECENT] = ns;
        self.n_made += 1;
    }

    /// How long before its instant the next frame is to be begun; `None` when too
    /// little is known.
    pub(crate) fn lead_ns(&self) -> Option<u64> {
        if self.n_made < N_KNOWN_MIN {
            return None;
        }
        let mut known = self.recent_ns;
        let known = &mut known[..self.n_made.min(N_RECENT)];
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
    fn it_is_learned_from_the_recent_frames() {
        let mut lead = LeadTime::UNKNOWN;
        for _ in 0..N_KNOWN_MIN {
            assert_eq!(lead.lead_ns(), None);
            lead.made_in(8_000_000);
        }
        assert_eq!(lead.lead_ns(), Some(12_000_000));
        for _ in 0..N_RECENT {
            lead.made_in(4_000_000);
        }
        assert_eq!(lead.lead_ns(), Some(7_000_000));
    }

    #[test]
    fn single_slow_frames_do_not_matter_many_do() {
        let mut lead = LeadTime::UNKNOWN;
        for frame in 0..N_RECENT {
            lead.made_in(if frame % 20 == 0 {
                30_000_000
            } else {
                4_000_000
            });
        }
        assert_eq!(lead.lead_ns(), Some(7_000_000));
        for frame in 0..N_RECENT {
            lead.made_in(if frame % 5 == 0 {
                30_000_000
            } else {
                4_000_000
            });
        }
        assert_eq!(lead.lead_ns(), Some(39_500_000));
    }
}
