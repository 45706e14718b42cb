//! Queue of a mailbox, protected by its lock. Every change is a function without
//! waiting, and returns the wakers to call once the lock is released.

use std::collections::VecDeque;
use std::task::{Context, Waker};

/// Capacity reserved at the start, messages.
const USUAL_CAPACITY: usize = 4;

pub(crate) struct Queue<T> {
    messages: VecDeque<T>,
    reader: Option<Waker>,
    /// Senders waiting for room, first come, first served. On the heap because most
    /// mailboxes never have any, and are small in the cache without.
    #[expect(clippy::box_collection, reason = "two cache lines for a mailbox")]
    waiting: Option<Box<VecDeque<(Ticket, Waker)>>>,
    n_tickets: u64,
    pub(crate) state: QueueState,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum QueueState {
    Open,
    /// Mailbox without senders; queued messages can still be received.
    Disconnected,
    /// Closed mailbox: no message is received any more.
    Closed,
}

/// Position of a sender in the line of waiting senders.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Ticket(u64);

/// Wakers of the tasks that may continue; dropping it does not wake them.
#[must_use]
#[derive(Default)]
pub(crate) struct Wakers {
    reader: Option<Waker>,
    sender: Option<Waker>,
}

impl Wakers {
    pub(crate) fn wake(self) {
        self.reader.into_iter().for_each(Waker::wake);
        self.sender.into_iter().for_each(Waker::wake);
    }
}

/// Outcome of an attempt to push in order.
pub(crate) enum PushOutcome {
    Pushed(Wakers),
    Wait,
    Closed,
}

impl<T> Queue<T> {
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            // Adjacent to the mailbox in memory, if allocated at once.
            messages: VecDeque::with_capacity(capacity.min(USUAL_CAPACITY)),
            reader: None,
            waiting: None,
            n_tickets: 0,
            state: QueueState::Open,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.messages.len()
    }

    pub(crate) fn push(&mut self, message: T) -> Wakers {
        self.messages.push_back(message);
        Wakers {
            reader: self.reader.take(),
            sender: None,
        }
    }

    pub(crate) fn pop(&mut self) -> Option<T> {
        self.messages.pop_front()
    }

    /// Pushes the message if there is room and no other sender has waited longer;
    /// otherwise the sender gets a ticket, or keeps the one it has.
    pub(crate) fn push_in_order(
        &mut self,
        message: &mut Option<T>,
        ticket: &mut Option<Ticket>,
        capacity: usize,
        context: &Context<'_>,
    ) -> PushOutcome {
        let position = ticket.and_then(|ticket| self.position(ticket));
        if self.state == QueueState::Closed || (ticket.is_some() && position.is_none()) {
            // Closing took the ticket away.
            *ticket = None;
            return PushOutcome::Closed;
        }
        let is_first = position.map_or(self.first().is_none(), |position| position == 0);
        if is_first && self.len() < capacity {
            if let (Some(_), Some(waiting)) = (ticket.take(), &mut self.waiting) {
                waiting.pop_front();
            }
            let mut wakers = message.take().map(|m| self.push(m)).unwrap_or_default();
            wakers.sender = self.next_sender(capacity);
            return PushOutcome::Pushed(wakers);
        }
        match (position, &mut self.waiting) {
            (Some(position), Some(waiting)) => waiting[position].1.clone_from(context.waker()),
            _ => *ticket = Some(self.enqueue_sender(context)),
        }
        PushOutcome::Wait
    }

    /// Cancels a wait; the next sender may have been waiting behind it.
    pub(crate) fn cancel_wait(&mut self, ticket: Ticket, capacity: usize) -> Wakers {
        if let (Some(position), Some(waiting)) = (self.position(ticket), &mut self.waiting) {
            waiting.remove(position);
        }
        Wakers {
            reader: None,
            sender: self.next_sender(capacity),
        }
    }

    /// Waker of the first waiting sender, if there is room for its message.
    pub(crate) fn next_sender(&self, capacity: usize) -> Option<Waker> {
        let first = self.first().filter(|_| self.len() < capacity);
        first.map(|(_, waker)| waker.clone())
    }

    pub(crate) fn register_reader(&mut self, context: &Context<'_>) {
        match &mut self.reader {
            Some(reader) => reader.clone_from(context.waker()),
            none => *none = Some(context.waker().clone()),
        }
    }

    /// Marks the queue as disconnected: no sender is left.
    pub(crate) fn disconnect(&mut self) -> Wakers {
        if self.state == QueueState::Open {
            self.state = QueueState::Disconnected;
        }
        Wakers {
            reader: self.reader.take(),
            sender: None,
        }
    }

    /// Closes the queue; its contents must be dropped, and all waiters woken, outside
    /// the lock.
    pub(crate) fn close(&mut self) -> ClosedQueue<T> {
        self.state = QueueState::Closed;
        ClosedQueue {
            messages: std::mem::take(&mut self.messages),
            reader: self.reader.take(),
            waiting: self
                .waiting
                .take()
                .map(|waiting| *waiting)
                .unwrap_or_default(),
        }
    }

    fn position(&self, ticket: Ticket) -> Option<usize> {
        let waiting = self.waiting.as_ref()?;
        waiting.iter().position(|(other, _)| *other == ticket)
    }

    /// Sender that has waited longest.
    fn first(&self) -> Option<&(Ticket, Waker)> {
        self.waiting.as_ref()?.front()
    }

    fn enqueue_sender(&mut self, context: &Context<'_>) -> Ticket {
        self.n_tickets += 1;
        let ticket = Ticket(self.n_tickets);
        let waiting = self.waiting.get_or_insert_default();
        waiting.push_back((ticket, context.waker().clone()));
        ticket
    }
}

/// Contents of a closed queue.
#[must_use]
pub(crate) struct ClosedQueue<T> {
    messages: VecDeque<T>,
    reader: Option<Waker>,
    waiting: VecDeque<(Ticket, Waker)>,
}

impl<T> ClosedQueue<T> {
    /// Wakes all waiters at both ends, then drops the messages.
    pub(crate) fn wake_and_drop(self) {
        self.reader.into_iter().for_each(Waker::wake);
        for (_, waker) in self.waiting {
            waker.wake();
        }
        drop(self.messages);
    }
}
