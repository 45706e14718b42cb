//! Telling perception that something was learned.

use channel::topic::MemoryChanged;
use channel::{Domain, Error, Publisher};
use message::{MemoryChange, PlainHeader};
use std::time::Duration;
use store::Position;
use tokio::sync::watch;

/// How often readers that have come since are greeted.
const PERIOD: Duration = Duration::from_millis(500);

/// Publishes the newest position of the history, and again to new readers.
pub(crate) struct Announcer {
    publisher: Publisher<MemoryChanged>,
    position: watch::Receiver<Position>,
}

impl Announcer {
    pub(crate) fn new(domain: &Domain, position: watch::Receiver<Position>) -> Result<Self, Error> {
        Ok(Self {
            publisher: Publisher::new(domain)?,
            position,
        })
    }

    /// Shared memory of the publisher.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.publisher.reservation().bytes()
    }

    pub(crate) async fn run(mut self) {
        let mut period = tokio::time::interval(PERIOD);
        loop {
            let is_news = tokio::select! {
                changed = self.position.changed() => match changed {
                    Ok(()) => true,
                    Err(_) => return,
                },
                _ = period.tick() => false,
            };
            let told = if is_news {
                self.tell()
            } else {
                self.publisher.greet_new_subscribers()
            };
            if let Err(error) = told {
                tracing::warn!("a change of the memory was not announced: {error}");
            }
        }
    }

    fn tell(&mut self) -> Result<(), Error> {
        let Position { store_id, sequence } = *self.position.borrow_and_update();
        let store_id = [(store_id.0 >> 64) as u64, store_id.0 as u64];
        self.publisher.send_copy(
            PlainHeader::default(),
            &[MemoryChange { store_id, sequence }],
        )
    }
}
