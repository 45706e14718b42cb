//! Bounded queue between the receiver and the writer: the newest messages win.

use crate::queued_message::QueuedMessage;
use parking_lot::{Condvar, Mutex};
use std::collections::VecDeque;
use std::time::Duration;

/// Largest number of waiting frames. Together with the one that is written and the one that is
/// received they stay below the number that a subscriber may hold, so that new ones arrive.
pub(crate) const MAX_FRAMES: usize = 3;
/// Largest number of waiting messages: about 5 s of all topics.
const MAX_MESSAGES: usize = 4096;

/// Queue of received messages in the order of their reception.
#[derive(Debug, Default)]
pub(crate) struct MessageQueue {
    state: Mutex<QueueState>,
    filled: Condvar,
}

#[derive(Debug, Default)]
struct QueueState {
    messages: VecDeque<QueuedMessage>,
    n_frames: usize,
    is_closed: bool,
    dropped: Dropped,
}

/// Numbers of messages that were displaced by newer ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Dropped {
    pub(crate) frames: u64,
    pub(crate) others: u64,
}

impl MessageQueue {
    /// Appends a message; a full queue drops the oldest of its kind.
    pub(crate) fn push(&self, message: QueuedMessage) {
        let mut state = self.state.lock();
        if message.is_frame() && state.n_frames >= MAX_FRAMES {
            state.drop_oldest(true);
        } else if state.messages.len() >= MAX_MESSAGES {
            state.drop_oldest(false);
        }
        state.n_frames += usize::from(message.is_frame());
        state.messages.push_back(message);
        drop(state);
        self.filled.notify_one();
    }

    /// Takes the oldest message; waits for one for at most `limit`.
    pub(crate) fn take(&self, limit: Duration) -> Taken {
        let mut state = self.state.lock();
        let is_empty = |state: &mut QueueState| state.messages.is_empty() && !state.is_closed;
        self.filled.wait_while_for(&mut state, is_empty, limit);
        match state.messages.pop_front() {
            Some(message) => {
                state.n_frames -= usize::from(message.is_frame());
                Taken::Message(message)
            }
            None if state.is_closed => Taken::End,
            None => Taken::Nothing,
        }
    }

    /// Ends the queue: the messages in it are still taken.
    pub(crate) fn close(&self) {
        self.state.lock().is_closed = true;
        self.filled.notify_one();
    }

    /// Numbers of displaced messages so far.
    pub(crate) fn dropped(&self) -> Dropped {
        self.state.lock().dropped
    }
}

impl QueueState {
    fn drop_oldest(&mut self, is_frame: bool) {
        let oldest = self.messages.iter().position(|m| m.is_frame() == is_frame);
        if let Some(oldest) = oldest {
            self.messages.remove(oldest);
            if is_frame {
                self.n_frames -= 1;
                self.dropped.frames += 1;
            } else {
                self.dropped.others += 1;
            }
        }
    }
}

/// Result of taking a message.
#[derive(Debug)]
pub(crate) enum Taken {
    Message(QueuedMessage),
    /// No message came within the time.
    Nothing,
    /// The queue is closed and empty.
    End,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queued_message::Content;
    use message::MemoryChange;

    fn change(sequence: u64) -> QueuedMessage {
        let change = MemoryChange {
            sequence,
            ..MemoryChange::default()
        };
        QueuedMessage {
            received_ns: sequence,
            content: Content::Memory(change),
        }
    }

    #[test]
    fn full_queue_keeps_the_newest_messages_in_their_order() {
        let queue = MessageQueue::default();
        for sequence in 0..MAX_MESSAGES as u64 + 3 {
            queue.push(change(sequence));
        }
        queue.close();
        let mut taken = Vec::new();
        while let Taken::Message(message) = queue.take(Duration::ZERO) {
            taken.push(message.received_ns);
        }
        assert!(taken.iter().copied().eq(3..MAX_MESSAGES as u64 + 3));
        assert_eq!(
            queue.dropped(),
            Dropped {
                frames: 0,
                others: 3
            }
        );
        assert!(matches!(queue.take(Duration::ZERO), Taken::End));
    }

    #[test]
    fn open_queue_without_messages_is_not_at_its_end() {
        let queue = MessageQueue::default();
        assert!(matches!(queue.take(Duration::ZERO), Taken::Nothing));
    }
}
