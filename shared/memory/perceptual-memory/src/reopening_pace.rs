//! Pace of the attempts to open a failed store again: they take a tenth of the time at most, so
//! that a store whose opening is expensive is not read all the time.

use std::time::{Duration, Instant};

/// Pause after an attempt, in multiples of its duration. Chosen.
const PAUSE_FACTOR: u32 = 10;
/// Shortest pause: a disk that has room again is used soon. Chosen.
const SHORTEST_PAUSE: Duration = Duration::from_millis(250);
/// Longest pause. Chosen.
const LONGEST_PAUSE: Duration = Duration::from_secs(30);

/// Time of the next attempt.
#[derive(Debug, Default)]
pub(crate) struct ReopeningPace {
    next: Option<Instant>,
}

impl ReopeningPace {
    /// `true` if an attempt may be made now.
    pub(crate) fn is_due(&self, now: Instant) -> bool {
        self.next.is_none_or(|next| now >= next)
    }

    /// Notes an attempt that failed.
    pub(crate) fn failed(&mut self, began: Instant, ended: Instant) {
        let pause = ended.saturating_duration_since(began) * PAUSE_FACTOR;
        self.next = Some(ended + pause.clamp(SHORTEST_PAUSE, LONGEST_PAUSE));
    }

    /// Notes an attempt that succeeded.
    pub(crate) fn succeeded(&mut self) {
        self.next = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pause_grows_with_the_duration_of_an_attempt() {
        let began = Instant::now();
        let mut pace = ReopeningPace::default();
        assert!(pace.is_due(began));
        for (duration_ms, pause_ms) in [(0, 250), (100, 1000), (60_000, 30_000)] {
            let ended = began + Duration::from_millis(duration_ms);
            pace.failed(began, ended);
            assert!(!pace.is_due(ended + Duration::from_millis(pause_ms - 1)));
            assert!(pace.is_due(ended + Duration::from_millis(pause_ms)));
        }
        pace.succeeded();
        assert!(pace.is_due(began));
    }
}
