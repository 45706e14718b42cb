//! Correction of coordinated omission: frames that never came count until the next labels.

/// Scheduled and published time of a completed frame, monotonic clock, nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FrameCompletion {
    pub(crate) session: u64,
    pub(crate) sequence: u64,
    pub(crate) scheduled_ns: u64,
    pub(crate) published_ns: u64,
}

/// Frames that were due and never came, with the latencies they count.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MissedFrames {
    /// Period of the schedule, nanoseconds; 0 for fewer than two frames.
    pub period_ns: u64,
    /// Number of captured frames without labels.
    pub n_dropped: u64,
    /// Number of scheduled captures without a frame from the source.
    pub n_not_captured: u64,
    /// Latency of each missed frame of both kinds: from its schedule to the next published
    /// labels, nanoseconds.
    pub missed_ns: Vec<u64>,
}

impl MissedFrames {
    /// Finds the gaps between completed frames in order of session and sequence.
    pub(crate) fn of(frames: &[FrameCompletion]) -> Self {
        let mut missed = Self {
            period_ns: period_ns(frames),
            ..Self::default()
        };
        for pair in frames.windows(2) {
            if pair[0].session == pair[1].session {
                missed.add_missed_between(&pair[0], &pair[1]);
            }
        }
        missed
    }

    /// Adds the frames missed between two consecutive completed frames. A source that falls
    /// behind moves its schedule: the captures it skipped have no sequence number.
    fn add_missed_between(&mut self, before: &FrameCompletion, after: &FrameCompletion) {
        let between_ns = after.scheduled_ns.saturating_sub(before.scheduled_ns);
        let n_sequences = after.sequence.saturating_sub(before.sequence).max(1);
        let n_periods = match self.period_ns {
            0 => n_sequences,
            period_ns => (between_ns + period_ns / 2) / period_ns,
        };
        let n_instants = n_periods.max(n_sequences);
        self.n_dropped += n_sequences - 1;
        self.n_not_captured += n_instants - n_sequences;
        for instant in 1..n_instants {
            let due_ns = before.scheduled_ns + between_ns * instant / n_instants;
            self.missed_ns
                .push(after.published_ns.saturating_sub(due_ns));
        }
    }
}

/// Median time from one frame's schedule to the next, nanoseconds.
fn period_ns(frames: &[FrameCompletion]) -> u64 {
    let mut periods: Vec<u64> = frames
        .windows(2)
        .filter(|pair| pair[0].session == pair[1].session)
        .map(|pair| {
            let between_ns = pair[1].scheduled_ns.saturating_sub(pair[0].scheduled_ns);
            let n_sequences = pair[1].sequence.saturating_sub(pair[0].sequence);
            between_ns / n_sequences.max(1)
        })
        .collect();
    let middle = periods.len() / 2;
    if periods.is_empty() {
        return 0;
    }
    *periods.select_nth_unstable(middle).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of a 100 ns schedule that take 30 ns; `schedule` has (sequence, instant) pairs.
    fn frames(schedule: &[(u64, u64)]) -> Vec<FrameCompletion> {
        let frame = |&(sequence, instant): &(u64, u64)| FrameCompletion {
            session: 1,
            sequence,
            scheduled_ns: instant * 100,
            published_ns: instant * 100 + 30,
        };
        schedule.iter().map(frame).collect()
    }

    #[test]
    fn continuous_frames_have_no_missed_frames() {
        let whole: Vec<_> = (0..20).map(|i| (i, i)).collect();
        let missed = MissedFrames::of(&frames(&whole));
        assert_eq!(missed.period_ns, 100);
        assert_eq!((missed.n_dropped, missed.n_not_captured), (0, 0));
        assert!(missed.missed_ns.is_empty());
    }

    #[test]
    fn dropped_frames_count_until_the_next_labels() {
        let missed = MissedFrames::of(&frames(&[(0, 0), (1, 1), (2, 2), (5, 5), (6, 6)]));
        assert_eq!((missed.n_dropped, missed.n_not_captured), (2, 0));
        assert_eq!(missed.missed_ns, [230, 130]);
    }

    #[test]
    fn skipped_captures_count_until_the_next_labels() {
        let missed = MissedFrames::of(&frames(&[(0, 0), (1, 1), (2, 2), (3, 5), (4, 6)]));
        assert_eq!((missed.n_dropped, missed.n_not_captured), (0, 2));
        assert_eq!(missed.missed_ns, [230, 130]);
    }

    #[test]
    fn gaps_between_sessions_are_not_missed_frames() {
        let mut two = frames(&[(7, 0), (8, 1), (0, 90), (1, 91)]);
        two[2].session = 2;
        two[3].session = 2;
        assert!(MissedFrames::of(&two).missed_ns.is_empty());
        assert_eq!(MissedFrames::of(&[]), MissedFrames::default());
    }
}
