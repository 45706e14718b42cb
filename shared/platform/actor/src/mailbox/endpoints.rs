//! Sender and receiver of a mailbox.

use std::fmt;
use std::future::poll_fn;
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::task::{Context, Poll, ready};

use tokio::task::coop;

use super::overflow::{Backpressure, Immediate, Overflow};
use super::queue::{PushOutcome, Queue, QueueState, Ticket};
use super::send_error::SendError;
use crate::sync::{Arc, AtomicU64, AtomicUsize, Mutex, MutexGuard, Ordering, PoisonError};

struct Shared<T> {
    queue: Mutex<Queue<T>>,
    capacity: usize,
    n_dropped: AtomicU64,
    n_senders: AtomicUsize,
}

impl<T> Shared<T> {
    /// No user code runs under the lock, so the data behind a poisoned lock is
    /// intact.
    fn lock(&self) -> MutexGuard<'_, Queue<T>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn close(&self) {
        // A separate statement, so that the lock is released before the rest.
        let closed = self.lock().close();
        closed.wake_and_drop();
    }
}

/// Sending end of a mailbox; cheap to clone.
pub struct Sender<T, P> {
    shared: Arc<Shared<T>>,
    policy: PhantomData<P>,
}

/// Receiving end of a mailbox.
pub struct Receiver<T, P> {
    shared: Arc<Shared<T>>,
    policy: PhantomData<P>,
}

/// Creates a mailbox for at most `capacity` messages. A large queue grows as it fills
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
    /// Number of messages displaced by newer ones.
    pub fn dropped(&self) -> u64 {
        self.shared.n_dropped.load(Ordering::Relaxed)
    }

    /// `true` when the mailbox is closed: no message sent from now on will be
    /// received.
    pub fn is_closed(&self) -> bool {
        self.shared.lock().state == QueueState::Closed
    }

    /// Closes the mailbox from the sending side: queued messages are discarded at
    /// once and the receiver gets `None`.
    pub fn close(&self) {
        self.shared.close();
    }
}

impl<T, P: Immediate> Sender<T, P> {
    /// Sends without waiting. Under [`DropOldest`](super::DropOldest) a
    /// displaced message is dropped before this returns.
    ///
    /// # Errors
    /// [`SendError::Full`] under [`Refuse`](super::Refuse);
    /// [`SendError::Closed`] when the receiver is gone.
    pub fn send(&self, message: T) -> Result<(), SendError<T>> {
        let mut queue = self.shared.lock();
        if queue.state == QueueState::Closed {
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

impl<T> Sender<T, Backpressure> {
    /// Sends after waiting for room; first come, first served. Dropping the future
    /// sends nothing.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the receiver is gone.
    pub async fn send(&self, message: T) -> Result<(), SendError<T>> {
        let mut waiting = WaitingSender {
            shared: &self.shared,
            ticket: None,
        };
        let mut message = Some(message);
        let is_sent = poll_fn(|context| waiting.poll_push(&mut message, context)).await;
        match message {
            Some(message) if !is_sent => Err(SendError::Closed(message)),
            _ => Ok(()),
        }
    }
}

/// Queue position of a waiting sender; dropping it lets the next one advance.
struct WaitingSender<'a, T> {
    shared: &'a Shared<T>,
    ticket: Option<Ticket>,
}

impl<T> WaitingSender<'_, T> {
    /// Ready when the message was taken (`true`) or the mailbox is closed.
    fn poll_push(&mut self, message: &mut Option<T>, context: &mut Context<'_>) -> Poll<bool> {
        let budget = ready!(coop::poll_proceed(context));
        let mut queue = self.shared.lock();
        let capacity = self.shared.capacity;
        let outcome = queue.push_in_order(message, &mut self.ticket, capacity, context);
        drop(queue);
        let is_sent = match outcome {
            PushOutcome::Wait => return Poll::Pending,
            PushOutcome::Closed => false,
            PushOutcome::Pushed(wakers) => {
                wakers.wake();
                true
            }
        };
        budget.made_progress();
        Poll::Ready(is_sent)
    }
}

impl<T> Drop for WaitingSender<'_, T> {
    fn drop(&mut self) {
        if let Some(ticket) = self.ticket {
            let wakers = self.shared.lock().cancel_wait(ticket, self.shared.capacity);
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
    /// Receives the next message; `None` when the mailbox is closed, or empty without
    /// any sender left. Dropping the future loses no message.
    pub async fn recv(&mut self) -> Option<T> {
        poll_fn(|context| self.poll_recv(context)).await
    }

    fn poll_recv(&mut self, context: &mut Context<'_>) -> Poll<Option<T>> {
        // Yields to other tasks from time to time even while messages are waiting
        // (tokio's coop budget).
        let budget = ready!(coop::poll_proceed(context));
        let mut queue = self.shared.lock();
        let received = queue.pop();
        if received.is_none() && queue.state == QueueState::Open {
            queue.register_reader(context);
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

    /// Returns when the mailbox is closed; messages stay queued.
    pub(crate) async fn closed(&mut self) {
        poll_fn(|context| {
            let mut queue = self.shared.lock();
            if queue.state == QueueState::Closed {
                return Poll::Ready(());
            }
            queue.register_reader(context);
            Poll::Pending
        })
        .await;
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.shared.lock().state == QueueState::Closed
    }
}

impl<T, P> Receiver<T, P> {
    /// Number of messages displaced by newer ones.
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
