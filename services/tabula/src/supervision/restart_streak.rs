//! Restart streak of one process: exponential back-off without a limit of attempts, and
//! thinning of the log of repeated ends. Pure functions of passed-in values.

use std::collections::BTreeSet;
use std::time::Duration;

/// Delay before the first restart of a streak. Chosen.
const FIRST_DELAY: Duration = Duration::from_millis(50);
/// Time of work, from readiness to the last progress, after which a streak is over. Chosen.
const RAN_WELL: Duration = Duration::from_secs(10);
/// Number of different causes of one streak that are logged at once. Chosen.
const MAX_CAUSES: usize = 16;

/// Ends of a process in a row, without a run in between that went well for a while.
#[derive(Debug, Clone)]
pub(crate) struct RestartStreak {
    longest_delay: Duration,
    n_ends: u32,
    last_delay: Duration,
    causes: BTreeSet<String>,
}

/// Decision about one end of the process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RestartDelay {
    /// Delay before the restart.
    pub(crate) delay: Duration,
    /// Number of the end in its streak, from 1.
    pub(crate) n_ends: u32,
    /// `true` if the end is to be logged: one of a cause that is new in the streak, and
    /// otherwise each whose number is a power of two.
    pub(crate) is_logged: bool,
}

impl RestartStreak {
    /// Creates a streak without ends.
    pub(crate) fn new(longest_delay: Duration) -> Self {
        Self {
            longest_delay,
            n_ends: 0,
            last_delay: Duration::ZERO,
            causes: BTreeSet::new(),
        }
    }

    /// Replaces the longest delay.
    pub(crate) fn set_longest_delay(&mut self, longest_delay: Duration) {
        self.longest_delay = longest_delay;
    }

    /// Decides about an end with this cause, after the process has worked for a time; zero
    /// when it was never ready.
    pub(crate) fn on_end(&mut self, cause: &str, worked_for: Duration) -> RestartDelay {
        if worked_for >= RAN_WELL {
            self.n_ends = 0;
            self.causes.clear();
        }
        let delay = self.delay();
        self.last_delay = delay;
        self.n_ends = self.n_ends.saturating_add(1);
        let is_new = self.causes.len() < MAX_CAUSES && self.causes.insert(cause.to_owned());
        RestartDelay {
            delay,
            n_ends: self.n_ends,
            is_logged: is_new || self.n_ends.is_power_of_two(),
        }
    }

    /// Number of ends in the streak.
    pub(crate) fn n_ends(&self) -> u32 {
        self.n_ends
    }

    /// Delay of the last decision.
    pub(crate) fn last_delay(&self) -> Duration {
        self.last_delay
    }

    /// Delay after as many ends: doubled with each, up to the longest.
    fn delay(&self) -> Duration {
        let doubled = 1_u32.checked_shl(self.n_ends).unwrap_or(u32::MAX);
        FIRST_DELAY.saturating_mul(doubled).min(self.longest_delay)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONGEST: Duration = Duration::from_secs(30);

    #[test]
    fn delay_doubles_up_to_the_longest_and_stays_there() {
        let mut streak = RestartStreak::new(LONGEST);
        let delays: Vec<u128> = (0..12)
            .map(|_| {
                streak
                    .on_end("exit status: 1", Duration::ZERO)
                    .delay
                    .as_millis()
            })
            .collect();
        let expected = [
            50, 100, 200, 400, 800, 1600, 3200, 6400, 12_800, 25_600, 30_000, 30_000,
        ];
        assert_eq!(delays, expected);
        for _ in 0..10_000 {
            assert_eq!(
                streak.on_end("exit status: 1", Duration::ZERO).delay,
                LONGEST
            );
        }
    }

    #[test]
    fn longest_delay_can_be_replaced_in_a_streak() {
        let mut streak = RestartStreak::new(LONGEST);
        for _ in 0..20 {
            streak.on_end("exit status: 1", Duration::ZERO);
        }
        let shorter = Duration::from_secs(2);
        streak.set_longest_delay(shorter);
        let end = streak.on_end("exit status: 1", Duration::ZERO);
        assert_eq!((end.delay, end.n_ends), (shorter, 21));
    }

    #[test]
    fn delay_begins_anew_after_a_run_that_went_well() {
        let mut streak = RestartStreak::new(LONGEST);
        for _ in 0..20 {
            streak.on_end("signal: 9", Duration::ZERO);
        }
        let too_short = RAN_WELL.mul_f64(0.999);
        let short = streak.on_end("signal: 9", too_short);
        assert_eq!((short.delay, short.n_ends), (LONGEST, 21));
        let after = streak.on_end("signal: 9", RAN_WELL);
        assert_eq!((after.delay, after.n_ends), (FIRST_DELAY, 1));
        assert!(after.is_logged);
    }

    #[test]
    fn equal_ends_are_logged_ever_more_sparsely() {
        let mut streak = RestartStreak::new(LONGEST);
        let logged: Vec<u32> = (0..3000)
            .map(|_| streak.on_end("exit status: 1", Duration::ZERO))
            .filter(|end| end.is_logged)
            .map(|end| end.n_ends)
            .collect();
        assert_eq!(logged, [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048]);
    }

    #[test]
    fn new_cause_is_logged_once_and_alternating_causes_are_not() {
        let mut streak = RestartStreak::new(LONGEST);
        let causes = ["a", "b", "a", "b", "c", "a", "b", "c", "a"];
        let logged = causes.map(|cause| streak.on_end(cause, Duration::ZERO).is_logged);
        // Numbers 1, 2, 4 and 8 are powers of two; number 5 has a new cause.
        assert_eq!(
            logged,
            [true, true, false, true, true, false, false, true, false]
        );
        let n_logged = (0..1000)
            .filter(|n| {
                streak
                    .on_end(&format!("cause {n}"), Duration::ZERO)
                    .is_logged
            })
            .count();
        assert!(n_logged < 30, "{n_logged} lines of ever new causes");
    }
}
