//! What the lock of a mailbox protects; every change is a function without
//! waiting, and hands back whom to wake once the lock is released.

use std::collections::VecDeque;
use std::task::{Context, Waker};

/// So many messages have their place from the beginning.
const USUAL_CAPACITY: usize = 4;

pub(crate) struct Queue<T> {
    messages: VecDeque<T>,
    reader: Option<Waker>,
    /// Senders that wait for room, in the order of asking. On the heap, for
    /// most mailboxes never have any, and are small in the cache without.
    #[expect(clippy::box_collection, reason = "two cache lines for a mailbox")]
    waiting: Option<Box<VecDeque<(Ticket, Waker)>>>,
    n_tickets: u64,
    pub(crate) state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum State {
    Open,
    /// No sender is left; what is queued can still be received.
    Disconnected,
    /// Nothing is received any more.
    Closed,
}

/// A place among the senders that wait.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Ticket(u64);

/// Those who may go on; dropping it does not wake them.
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

/// What becomes of a message that waits its turn.
pub(crate) enum Turn {
    Pushed(Wakers),
    Wait,
    Closed,
}

impl<T> Queue<T> {
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            // Beside the mailbox in memory, if taken at once.
            messages: VecDeque::with_capacity(capacity.min(USUAL_CAPACITY)),
            reader: None,
            waiting: None,
            n_tickets: 0,
            state: State::Open,
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

    /// Pushes the message if there is room and nobody has waited longer; else
    /// the sender gets a ticket, or keeps the one it has.
    pub(crate) fn push_in_turn(
        &mut self,
        message: &mut Option<T>,
        ticket: &mut Option<Ticket>,
        capacity: usize,
        context: &Context<'_>,
    ) -> Turn {
        let place = ticket.and_then(|ticket| self.place(ticket));
        if self.state == State::Closed || (ticket.is_some() && place.is_none()) {
            // Closing took the ticket away, even if it is open again by now.
            *ticket = None;
            return Turn::Closed;
        }
        let is_first = place.map_or(self.first().is_none(), |place| place == 0);
        if is_first && self.len() < capacity {
            if let (Some(_), Some(waiting)) = (ticket.take(), &mut self.waiting) {
                waiting.pop_front();
            }
            let mut wakers = message.take().map(|m| self.push(m)).unwrap_or_default();
            wakers.sender = self.next_sender(capacity);
            return Turn::Pushed(wakers);
        }
        match (place, &mut self.waiting) {
            (Some(place), Some(waiting)) => waiting[place].1.clone_from(context.waker()),
            _ => *ticket = Some(self.queue_up(context)),
        }
        Turn::Wait
    }

    /// Gives a ticket back; the next sender may have been waiting behind it.
    pub(crate) fn leave(&mut self, ticket: Ticket, capacity: usize) -> Wakers {
        if let (Some(place), Some(waiting)) = (self.place(ticket), &mut self.waiting) {
            waiting.remove(place);
        }
        Wakers {
            reader: None,
            sender: self.next_sender(capacity),
        }
    }

    /// The sender to wake, if there is room for it.
    pub(crate) fn next_sender(&self, capacity: usize) -> Option<Waker> {
        let first = self.first().filter(|_| self.len() < capacity);
        first.map(|(_, waker)| waker.clone())
    }

    pub(crate) fn await_change(&mut self, context: &Context<'_>) {
        match &mut self.reader {
            Some(reader) => reader.clone_from(context.waker()),
            none => *none = Some(context.waker().clone()),
        }
    }

    /// No sender is left.
    pub(crate) fn disconnect(&mut self) -> Wakers {
        if self.state == State::Open {
            self.state = State::Disconnected;
        }
        Wakers {
            reader: self.reader.take(),
            sender: None,
        }
    }

    /// Ends the queue; what it held is to be dropped, and everybody to be
    /// woken, outside the lock.
    pub(crate) fn close(&mut self) -> Remains<T> {
        self.state = State::Closed;
        Remains {
            messages: std::mem::take(&mut self.messages),
            reader: self.reader.take(),
            waiting: self
                .waiting
                .take()
                .map(|waiting| *waiting)
                .unwrap_or_default(),
        }
    }

    fn place(&self, ticket: Ticket) -> Option<usize> {
        let waiting = self.waiting.as_ref()?;
        waiting.iter().position(|(other, _)| *other == ticket)
    }

    /// The first of those who wait.
    fn first(&self) -> Option<&(Ticket, Waker)> {
        self.waiting.as_ref()?.front()
    }

    fn queue_up(&mut self, context: &Context<'_>) -> Ticket {
        self.n_tickets += 1;
        let ticket = Ticket(self.n_tickets);
        let waiting = self.waiting.get_or_insert_default();
        waiting.push_back((ticket, context.waker().clone()));
        ticket
    }
}

/// What was in a closed queue.
#[must_use]
pub(crate) struct Remains<T> {
    messages: VecDeque<T>,
    reader: Option<Waker>,
    waiting: VecDeque<(Ticket, Waker)>,
}

impl<T> Remains<T> {
    /// Wakes everyone who waits at either end, then drops the messages.
    pub(crate) fn scatter(self) {
        self.reader.into_iter().for_each(Waker::wake);
        for (_, waker) in self.waiting {
            waker.wake();
        }
        drop(self.messages);
    }
}
