//! Expiry queue: retention of ended items by age and number.

use std::collections::BTreeSet;

/// Ended items, ordered by the time of their end.
#[derive(Debug, Default)]
pub(crate) struct ExpiryQueue(BTreeSet<(u64, u64)>);

impl ExpiryQueue {
    /// Adds an ended item to the queue.
    pub(crate) fn insert(&mut self, over_ns: u64, number: u64) {
        self.0.insert((over_ns, number));
    }

    /// Removes an item that became active again.
    pub(crate) fn remove(&mut self, over_ns: u64, number: u64) {
        self.0.remove(&(over_ns, number));
    }

    /// Removes and returns the oldest item if it ended at least `keep_ns` ago, or if more than
    /// `n_most` items have ended.
    pub(crate) fn take(&mut self, now_ns: u64, keep_ns: u64, n_most: usize) -> Option<u64> {
        let &(over_ns, number) = self.0.first()?;
        let is_due = over_ns.saturating_add(keep_ns) <= now_ns || self.0.len() > n_most;
        is_due.then(|| {
            self.0.pop_first();
            number
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oldest_item_expires_first_by_age_and_number() {
        let mut expiry = ExpiryQueue::default();
        for (over_ns, number) in [(30, 1), (10, 2), (20, 3)] {
            expiry.insert(over_ns, number);
        }
        assert_eq!(expiry.take(109, 100, 3), None);
        assert_eq!(expiry.take(110, 100, 3), Some(2));
        assert_eq!(expiry.take(110, 100, 1), Some(3));
        expiry.remove(30, 1);
        assert_eq!(expiry.take(u64::MAX, 0, 0), None);
    }
}
