//! Clock of the playback of a recording.

/// Interval between two frames whose stamps do not grow: the recording goes on in another
/// session, or begins again. Nanoseconds, 30 Hz.
pub(super) const SESSION_GAP_NS: u64 = 33_333_333;

/// Longest interval between two frames of a playback, nanoseconds: after a minute every track
/// that is out of view has ended, so that nothing is gained by a longer wait.
const LONGEST_GAP_NS: u64 = 60_000_000_000;

/// Clock of the playback, which never goes back: the capture times of the recording, joined where
/// another session or another round begins.
#[derive(Debug, Default)]
pub(super) struct PlaybackClock {
    /// Capture time of the newest frame in the recording.
    recorded_ns: Option<u64>,
    now_ns: u64,
}

impl PlaybackClock {
    /// Moves the clock to the next frame.
    pub(super) fn advance_to(&mut self, recorded_ns: u64) {
        let interval_ns = match self.recorded_ns {
            None => 0,
            Some(before_ns) if recorded_ns > before_ns => {
                (recorded_ns - before_ns).min(LONGEST_GAP_NS)
            }
            Some(_) => SESSION_GAP_NS,
        };
        self.recorded_ns = Some(recorded_ns);
        self.now_ns = self.now_ns.saturating_add(interval_ns);
    }

    /// Time of the newest frame since the start of the playback, nanoseconds.
    pub(super) fn now_ns(&self) -> u64 {
        self.now_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn playback_clock_never_goes_back_and_waits_a_minute_at_most() {
        let mut clock = PlaybackClock::default();
        let mut time_at = |recorded_ns| {
            clock.advance_to(recorded_ns);
            clock.now_ns()
        };
        assert_eq!([time_at(700), time_at(750)], [0, 50]);
        assert_eq!(time_at(10), 50 + SESSION_GAP_NS);
        assert_eq!(time_at(u64::MAX), 50 + SESSION_GAP_NS + LONGEST_GAP_NS);
    }
}
