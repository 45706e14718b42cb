//! Newest position of the memory's history, for reads that have to include it (read-your-writes
//! consistency).

use channel::topic::MemoryChanged;
use channel::{Domain, Error, Received, Subscriber};
use control_protocol::Command;
use message::MemoryChange;
use parking_lot::Mutex;

/// Follower of the memory's announcements. The memory announces a change before it acknowledges
/// it, so that whoever has got an acknowledgement finds the change announced.
pub(crate) struct HistoryPosition(Mutex<Announcements>);

struct Announcements {
    subscriber: Subscriber<MemoryChanged>,
    newest: Option<MemoryChange>,
}

impl HistoryPosition {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self(Mutex::new(Announcements {
            subscriber: Subscriber::polled(domain)?,
            newest: None,
        })))
    }

    /// The command, to be answered with knowledge of all that was announced; itself while nothing
    /// was.
    pub(crate) fn stamp(&self, command: Command) -> Command {
        let mut announcements = self.0.lock();
        let Announcements { subscriber, newest } = &mut *announcements;
        while let Ok(Received::Message(message)) = subscriber.receive() {
            // Copied out of shared memory first.
            *newest = message.items().first().copied().or(*newest);
        }
        match newest {
            Some(change) => command.read_after(change.store_id(), change.sequence),
            None => command,
        }
    }
}
