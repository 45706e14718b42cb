//! Publisher of changes: announces each new position of the memory's history to the other
//! processes.

use channel::topic::MemoryChanged;
use channel::{Domain, Error, Publisher};
use message::{MemoryChange, PlainHeader};
use perceptual_memory::Position;
use std::time::Duration;
use tokio::sync::watch;

/// Period at which new subscribers receive the newest position.
const PERIOD: Duration = Duration::from_millis(500);

/// Publisher of the newest position in the history.
pub(crate) struct ChangePublisher {
    publisher: Publisher<MemoryChanged>,
    position: watch::Receiver<Position>,
    announced: watch::Sender<Position>,
}

impl ChangePublisher {
    /// Publisher of the position, and the newest one that it has announced.
    pub(crate) fn new(
        domain: &Domain,
        position: watch::Receiver<Position>,
    ) -> Result<(Self, watch::Receiver<Position>), Error> {
        let (announced, announcements) = watch::channel(*position.borrow());
        let publisher = Self {
            publisher: Publisher::new(domain)?,
            position,
            announced,
        };
        Ok((publisher, announcements))
    }

    /// Shared memory reserved by the publisher, bytes.
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
            let sent = if is_news {
                self.publish()
            } else {
                self.publisher.deliver_history()
            };
            if let Err(error) = sent {
                tracing::warn!("a change of the memory was not announced: {error}");
            }
        }
    }

    fn publish(&mut self) -> Result<(), Error> {
        let position = *self.position.borrow_and_update();
        let change = MemoryChange::new(position.store_id.0, position.sequence);
        self.publisher
            .send_copy(PlainHeader::default(), &[change])?;
        self.announced.send_replace(position);
        Ok(())
    }
}
