//! Which actors are not there for a moment, because they are about to start again.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Until when which actor rests. A frame does not wait for an actor that rests: one
/// that fails again and again would hold up all others.
///
/// A time rather than a state, so that a lost event leaves nobody resting for ever.
#[derive(Debug, Default)]
pub(crate) struct Resting(Mutex<BTreeMap<u64, Instant>>);

impl Resting {
    /// An actor starts again after a time.
    pub(crate) fn rest(&self, track_id: u64, after: Duration) {
        let until = Instant::now() + after;
        let mut resting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let held = resting.entry(track_id).or_insert(until);
        *held = until.max(*held);
    }

    /// Whether an actor rests now.
    pub(crate) fn is_resting(&self, track_id: u64) -> bool {
        let mut resting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_over = resting
            .get(&track_id)
            .is_some_and(|until| *until <= Instant::now());
        if is_over {
            resting.remove(&track_id);
        }
        resting.contains_key(&track_id)
    }

    /// Forgets an actor that has stopped for good.
    pub(crate) fn forget(&self, track_id: u64) {
        let mut resting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        resting.remove(&track_id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_actor_rests_for_the_longest_time_that_was_said_and_no_longer() {
        let resting = Resting::default();
        assert!(!resting.is_resting(1));
        resting.rest(1, Duration::from_secs(3600));
        resting.rest(1, Duration::ZERO);
        assert!(resting.is_resting(1) && !resting.is_resting(2));
        resting.rest(2, Duration::ZERO);
        assert!(!resting.is_resting(2));
        resting.forget(1);
        assert!(!resting.is_resting(1));
    }
}
