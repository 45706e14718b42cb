//! Track-ids, leased from the memory so that none is ever used twice.

use channel::control::Client;
use message::control::{Command, Reply};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// Ids of a lease. Those left over when the process ends are lost: 64 bits hold
/// enough.
const BLOCK: u32 = 64;
/// With fewer left, the next lease is fetched.
const FEW: u64 = 32;
/// How long the memory may take to answer.
const DEADLINE: Duration = Duration::from_secs(5);
/// How soon it is asked again after a failure.
const TRY_AGAIN: Duration = Duration::from_millis(50);
/// Failures shorter than this are not told.
const GRACE: Duration = Duration::from_secs(2);

/// Ids at hand.
#[derive(Debug, Default)]
pub(crate) struct TrackIds {
    blocks: Mutex<VecDeque<Range<u64>>>,
    is_short: Notify,
}

impl TrackIds {
    /// The next id; `None` while the memory has leased none.
    pub(crate) fn take(&self) -> Option<u64> {
        let mut blocks = self.blocks.lock().unwrap_or_else(PoisonError::into_inner);
        let id = loop {
            match blocks.front_mut() {
                None => break None,
                Some(block) => match block.next() {
                    None => drop(blocks.pop_front()),
                    id => break id,
                },
            }
        };
        if n_left(&blocks) < FEW {
            self.is_short.notify_one();
        }
        id
    }

    /// Waits until ids are at hand.
    pub(crate) async fn fetch_first(&self, client: &Client) {
        self.fetch(client).await;
    }

    /// Keeps ids at hand until the future is dropped.
    pub(crate) async fn keep(self: Arc<Self>, client: Arc<Client>) {
        loop {
            self.is_short.notified().await;
            if n_left(&self.blocks.lock().unwrap_or_else(PoisonError::into_inner)) < FEW {
                self.fetch(&client).await;
            }
        }
    }

    async fn fetch(&self, client: &Client) {
        let begun = Instant::now();
        let mut is_told = false;
        loop {
            // The memory may be starting at this moment.
            let is_silent = is_told || begun.elapsed() < GRACE;
            match client
                .call(Command::LeaseTrackIds { count: BLOCK }, DEADLINE)
                .await
            {
                Ok(Reply::TrackIds { first }) => {
                    let block = first..first.saturating_add(u64::from(BLOCK));
                    self.blocks
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .push_back(block);
                    return;
                }
                _ if is_silent => {}
                Ok(other) => tracing::error!("no track-ids were leased: {other:?}"),
                Err(error) => {
                    tracing::warn!("waiting for track-ids, new objects are not tracked: {error}");
                }
            }
            is_told |= !is_silent;
            tokio::time::sleep(TRY_AGAIN).await;
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
        ids.blocks.lock().unwrap().extend([5..7, 64..65]);
        let taken: Vec<_> = std::iter::from_fn(|| ids.take()).collect();
        assert_eq!(taken, [5, 6, 64]);
        assert_eq!(ids.take(), None);
    }
}
