//! The two ends of a mailbox.

use std::fmt;
use std::future::poll_fn;
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::task::{Context, Poll, ready};

use tokio::task::coop;

use super::overflow::{Block, Immediate, Overflow};
use super::queue::{Queue, State, Ticket, Turn};
use super::send_error::SendError;
use crate::sync::{Arc, AtomicU64, AtomicUsize, Mutex, MutexGuard, Ordering, PoisonError};

struct Shared<T> {
    queue: Mutex<Queue<T>>,
    capacity: usize,
    n_dropped: AtomicU64,
    n_senders: AtomicUsize,
}

impl<T> Shared<T> {
    /// No foreign code runs under the lock, so a poisoned one is still whole.
    fn lock(&self) -> MutexGuard<'_, Queue<T>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn close(&self) {
        // A statement of its own, so that the lock is released before the rest.
        let remains = self.lock().close();
        remains.scatter();
    }
}

/// The end that sends; cheap to clone.
pub struct Sender<T, P> {
    shared: Arc<Shared<T>>,
    policy: PhantomData<P>,
}

/// The end that receives.
pub struct Receiver<T, P> {
    shared: Arc<Shared<T>>,
    policy: PhantomData<P>,
}

/// A mailbox for at most `capacity` messages. A large queue grows as it fills
/// and is then reused, so that an idle mailbox stays small.
pub fn mailbox<T, P: Overflow>(capacity: NonZeroUsize) -> (Sender<T, P>, Receiver<T, P>) {
    let shared = Arc::new(Shared {
        queue: Mutex::new(Queue::new(capacity.get())),
        capacity: capacity.get(),
        n_dropped: AtomicU64::new(0),
        n_senders: AtomicUsize::new(1),
    });
    let receiver = Receiver {
        shared: Arc::clone(&shared),
        policy: PhantomData,
    };
    let sender = Sender {
        shared,
        policy: PhantomData,
    };
    (sender, receiver)
}

impl<T, P> Sender<T, P> {
    /// How many messages were displaced by newer ones.
    pub fn dropped(&self) -> u64 {
        self.shared.n_dropped.load(Ordering::Relaxed)
    }

    /// Whether nothing sent from now on will be received.
    pub fn is_closed(&self) -> bool {
        self.shared.lock().state == State::Closed
    }

    /// Ends the mailbox from this side: what is queued is discarded at once and
    /// the receiver gets `None`.
    pub fn close(&self) {
        self.shared.close();
    }
}

impl<T, P: Immediate> Sender<T, P> {
    /// Sends without waiting. Under [`KeepLatest`](super::KeepLatest) a
    /// displaced message is dropped before this returns.
    ///
    /// # Errors
    /// [`SendError::Full`] under [`Refuse`](super::Refuse);
    /// [`SendError::Closed`] when the receiver is gone.
    pub fn send(&self, message: T) -> Result<(), SendError<T>> {
        let mut queue = self.shared.lock();
        if queue.state == State::Closed {
            return Err(SendError::Closed(message));
        }
        let is_full = queue.len() >= self.shared.capacity;
        if is_full && !P::DISPLACES {
            return Err(SendError::Full(message));
        }
        let displaced = if is_full { queue.pop() } else { None };
        let wakers = queue.push(message);
        drop(queue);
        wakers.wake();
        if let Some(displaced) = displaced {
            self.shared.n_dropped.fetch_add(1, Ordering::Relaxed);
            drop(displaced);
        }
        Ok(())
    }
}

impl<T> Sender<T, Block> {
    /// Sends, waiting for room; first come, first served. Dropping the future
    /// sends nothing.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the receiver is gone.
    pub async fn send(&self, message: T) -> Result<(), SendError<T>> {
        let mut place = Place {
            shared: &self.shared,
            ticket: None,
        };
        let mut message = Some(message);
        let is_sent = poll_fn(|context| place.poll_push(&mut message, context)).await;
        match message {
            Some(message) if !is_sent => Err(SendError::Closed(message)),
            _ => Ok(()),
        }
    }
}

/// A sender's place in the line; dropping it lets the next one advance.
struct Place<'a, T> {
    shared: &'a Shared<T>,
    ticket: Option<Ticket>,
}

impl<T> Place<'_, T> {
    /// Ready once the message was taken (true) or the mailbox is closed.
    fn poll_push(&mut self, message: &mut Option<T>, context: &mut Context<'_>) -> Poll<bool> {
        let budget = ready!(coop::poll_proceed(context));
        let mut queue = self.shared.lock();
        let capacity = self.shared.capacity;
        let turn = queue.push_in_turn(message, &mut self.ticket, capacity, context);
        drop(queue);
        let is_sent = match turn {
            Turn::Wait => return Poll::Pending,
            Turn::Closed => false,
            Turn::Pushed(wakers) => {
                wakers.wake();
                true
            }
        };
        budget.made_progress();
        Poll::Ready(is_sent)
    }
}

impl<T> Drop for Place<'_, T> {
    fn drop(&mut self) {
        if let Some(ticket) = self.ticket {
            let wakers = self.shared.lock().leave(ticket, self.shared.capacity);
            wakers.wake();
        }
    }
}

impl<T, P> Clone for Sender<T, P> {
    fn clone(&self) -> Self {
        self.shared.n_senders.fetch_add(1, Ordering::Relaxed);
        Self {
            shared: Arc::clone(&self.shared),
            policy: PhantomData,
        }
    }
}

impl<T, P> Drop for Sender<T, P> {
    fn drop(&mut self) {
        // AcqRel: the last sender must come after all other senders' messages.
        if self.shared.n_senders.fetch_sub(1, Ordering::AcqRel) > 1 {
            return;
        }
        let wakers = self.shared.lock().disconnect();
        wakers.wake();
    }
}

impl<T, P: Overflow> Receiver<T, P> {
    /// The next message; `None` once the mailbox is closed, or empty without
    /// any sender left. Dropping the future loses no message.
    pub async fn recv(&mut self) -> Option<T> {
        poll_fn(|context| self.poll_recv(context)).await
    }

    fn poll_recv(&mut self, context: &mut Context<'_>) -> Poll<Option<T>> {
        // Yields now and then to other tasks although messages are waiting.
        let budget = ready!(coop::poll_proceed(context));
        let mut queue = self.shared.lock();
        let received = queue.pop();
        if received.is_none() && queue.state == State::Open {
            queue.await_change(context);
            return Poll::Pending;
        }
        let sender = if P::SENDERS_WAIT {
            queue.next_sender(self.shared.capacity)
        } else {
            None
        };
        drop(queue);
        budget.made_progress();
        if let Some(sender) = sender {
            sender.wake();
        }
        Poll::Ready(received)
    }

    /// Returns once the mailbox is closed; messages stay where they are.
    pub(crate) async fn closed(&mut self) {
        poll_fn(|context| {
            let mut queue = self.shared.lock();
            if queue.state == State::Closed {
                return Poll::Ready(());
            }
            queue.await_change(context);
            Poll::Pending
        })
        .await;
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.shared.lock().state == State::Closed
    }

    /// Takes messages again after a close; what was sent before stays lost.
    pub(crate) fn reopen(&mut self) {
        let mut queue = self.shared.lock();
        if queue.state == State::Closed {
            queue.state = State::Open;
        }
    }
}

impl<T, P> Receiver<T, P> {
    /// How many messages were displaced by newer ones.
    pub fn dropped(&self) -> u64 {
        self.shared.n_dropped.load(Ordering::Relaxed)
    }
}

impl<T, P> Drop for Receiver<T, P> {
    fn drop(&mut self) {
        self.shared.close();
    }
}

impl<T, P> fmt::Debug for Sender<T, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sender")
            .field("dropped", &self.dropped())
            .finish_non_exhaustive()
    }
}

impl<T, P> fmt::Debug for Receiver<T, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Receiver")
            .field("dropped", &self.dropped())
            .finish_non_exhaustive()
    }
}
