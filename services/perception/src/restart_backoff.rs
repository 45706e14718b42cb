//! Restart back-off of object actors: actors that are about to restart are not waited
//! for.

use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// End of the back-off by track-id. An actor that fails again and again would otherwise
/// delay every frame.
///
/// A time rather than a state, so that a lost event blocks no actor for ever.
#[derive(Debug, Default)]
pub(crate) struct RestartBackoff(Mutex<BTreeMap<u64, Instant>>);

impl RestartBackoff {
    /// Extends the back-off of an actor to at least `after` from now.
    pub(crate) fn extend(&self, track_id: u64, after: Duration) {
        let until = Instant::now() + after;
        let mut backoff = self.0.lock();
        let held = backoff.entry(track_id).or_insert(until);
        *held = until.max(*held);
    }

    /// True while an actor is in back-off.
    pub(crate) fn is_waiting(&self, track_id: u64) -> bool {
        let mut backoff = self.0.lock();
        let is_over = backoff
            .get(&track_id)
            .is_some_and(|until| *until <= Instant::now());
        if is_over {
            backoff.remove(&track_id);
        }
        backoff.contains_key(&track_id)
    }

    /// Removes an actor that has stopped permanently.
    pub(crate) fn remove(&self, track_id: u64) {
        let mut backoff = self.0.lock();
        backoff.remove(&track_id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_back_off_counts() {
        let backoff = RestartBackoff::default();
        assert!(!backoff.is_waiting(1));
        backoff.extend(1, Duration::from_secs(3600));
        backoff.extend(1, Duration::ZERO);
        assert!(backoff.is_waiting(1) && !backoff.is_waiting(2));
        backoff.extend(2, Duration::ZERO);
        assert!(!backoff.is_waiting(2));
        backoff.remove(1);
        assert!(!backoff.is_waiting(1));
    }
}
