//! Track-id leases: blocks of unique ids from the memory, so that no id is used twice.

use crate::log_once::LogOnce;
use channel::control::Client;
use control_protocol::request;
use parking_lot::Mutex;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// Size of a lease, ids. Ids left over when the process ends are lost; 64 bits suffice.
const LEASE_SIZE: u32 = 64;
/// Low-water mark: with fewer ids left, the next lease is fetched.
const LOW_WATER: u64 = 32;
/// Time limit for an answer of the memory.
const CALL_TIMEOUT: Duration = Duration::from_secs(5);
/// Pause before a failed lease is repeated.
const RETRY_PERIOD: Duration = Duration::from_millis(50);
/// Grace period: shorter failures are not logged.
const LOG_DELAY: Duration = Duration::from_secs(2);

/// Leased ids that are not used yet.
#[derive(Debug, Default)]
pub(crate) struct TrackIds {
    blocks: Mutex<VecDeque<Range<u64>>>,
    is_short: Notify,
}

impl TrackIds {
    /// Next id; `None` while no lease is available.
    pub(crate) fn take(&self) -> Option<u64> {
        let mut blocks = self.blocks.lock();
        let id = loop {
            match blocks.front_mut() {
                None => break None,
                Some(block) => match block.next() {
                    None => drop(blocks.pop_front()),
                    id => break id,
                },
            }
        };
        if n_left(&blocks) < LOW_WATER {
            self.is_short.notify_one();
        }
        id
    }

    /// Fetches the first lease of track-ids.
    pub(crate) async fn fetch_first(&self, client: &Client) {
        self.fetch(client).await;
    }

    /// Fetches leases at the low-water mark until the future is dropped.
    pub(crate) async fn keep(self: Arc<Self>, client: Arc<Client>) {
        loop {
            self.is_short.notified().await;
            if n_left(&self.blocks.lock()) < LOW_WATER {
                self.fetch(&client).await;
            }
        }
    }

    async fn fetch(&self, client: &Client) {
        let begun = Instant::now();
        let mut failure_log = LogOnce::default();
        loop {
            let lease = request::lease_track_ids(LEASE_SIZE);
            match client.ask(&lease, CALL_TIMEOUT).await {
                Ok(first) => {
                    let block = first..first.saturating_add(u64::from(LEASE_SIZE));
                    self.blocks.lock().push_back(block);
                    return;
                }
                // The memory may be starting at this moment.
                _ if begun.elapsed() < LOG_DELAY || !failure_log.is_first() => {}
                Err(error) => {
                    tracing::warn!("waiting for track-ids, new objects are not tracked: {error}");
                }
            }
            tokio::time::sleep(RETRY_PERIOD).await;
        }
    }
}

fn n_left(blocks: &VecDeque<Range<u64>>) -> u64 {
    blocks.iter().map(|block| block.end - block.start).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_come_in_order_over_blocks_and_then_none() {
        let ids = TrackIds::default();
        ids.blocks.lock().extend([5..7, 64..65]);
        let taken: Vec<_> = std::iter::from_fn(|| ids.take()).collect();
        assert_eq!(taken, [5, 6, 64]);
        assert_eq!(ids.take(), None);
    }
}
