//! The bounded mailbox: many senders, one receiver, the overflow policy in the type.
//!
//! A lock-protected queue rather than a lock-free ring: the sender must be able
//! to remove the oldest message, a push costs tens of nanoseconds, and a handler
//! takes a thousand times longer. Messages are dropped outside the lock, since
//! their `Drop` returns shared memory and is not ours.

use std::collections::VecDeque;
use std::fmt;
use std::future::poll_fn;
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker, ready};

use tokio::sync::Semaphore;
use tokio::task::coop;

mod overflow;
mod send_error;

pub use overflow::{Block, Immediate, KeepLatest, Overflow, Refuse};
pub use send_error::SendError;

struct Shared<T> {
    queue: Mutex<Queue<T>>,
    /// One permit for each free place; used under [`Block`] only.
    room: Semaphore,
    capacity: usize,
    n_dropped: AtomicU64,
    n_senders: AtomicUsize,
}

struct Queue<T> {
    messages: VecDeque<T>,
    reader: Option<Waker>,
    state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Open,
    /// No sender is left; what is queued can still be received.
    Disconnected,
    /// Nothing is received any more.
    Closed,
}

impl<T> Shared<T> {
    /// No foreign code runs under the lock, so a poisoned one is still whole.
    fn lock(&self) -> MutexGuard<'_, Queue<T>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Discards the queue and wakes everyone who waits at either end.
    fn close(&self) {
        let (discarded, reader) = {
            let mut queue = self.lock();
            queue.state = State::Closed;
            (std::mem::take(&mut queue.messages), queue.reader.take())
        };
        self.room.close();
        if let Some(reader) = reader {
            reader.wake();
        }
        drop(discarded);
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

/// A mailbox for at most `capacity` messages. The queue grows as it fills and
/// is then reused, so that an idle mailbox stays small.
pub fn mailbox<T, P: Overflow>(capacity: NonZeroUsize) -> (Sender<T, P>, Receiver<T, P>) {
    let capacity = capacity.get().min(Semaphore::MAX_PERMITS);
    let queue = Queue {
        messages: VecDeque::new(),
        reader: None,
        state: State::Open,
    };
    let shared = Arc::new(Shared {
        queue: Mutex::new(queue),
        room: Semaphore::new(if P::SENDERS_WAIT { capacity } else { 0 }),
        capacity,
        n_dropped: AtomicU64::new(0),
        n_senders: AtomicUsize::new(1),
    });
    let receiver = Receiver {
        shared: Arc::clone(&shared),
        policy: PhantomData,
    };
    (
        Sender {
            shared,
            policy: PhantomData,
        },
        receiver,
    )
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

    fn push(&self, message: T, full: Full) -> Result<(), SendError<T>> {
        let mut queue = self.shared.lock();
        if queue.state == State::Closed {
            return Err(SendError::Closed(message));
        }
        let is_full = queue.messages.len() >= self.shared.capacity;
        if is_full && full == Full::Refuses {
            return Err(SendError::Full(message));
        }
        let displaced = if is_full {
            queue.messages.pop_front()
        } else {
            None
        };
        queue.messages.push_back(message);
        let reader = queue.reader.take();
        drop(queue);
        if let Some(reader) = reader {
            reader.wake();
        }
        if let Some(displaced) = displaced {
            self.shared.n_dropped.fetch_add(1, Ordering::Relaxed);
            drop(displaced);
        }
        Ok(())
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Full {
    Displaces,
    Refuses,
}

impl<T, P: Immediate> Sender<T, P> {
    /// Sends without waiting. Under [`KeepLatest`] a displaced message is
    /// dropped before this returns.
    ///
    /// # Errors
    /// [`SendError::Full`] under [`Refuse`]; [`SendError::Closed`] when the
    /// receiver is gone.
    pub fn send(&self, message: T) -> Result<(), SendError<T>> {
        self.push(
            message,
            if P::DISPLACES {
                Full::Displaces
            } else {
                Full::Refuses
            },
        )
    }
}

impl<T> Sender<T, Block> {
    /// Sends, waiting for room; first come, first served. Dropping the future
    /// sends nothing.
    ///
    /// # Errors
    /// [`SendError::Closed`] when the receiver is gone.
    pub async fn send(&self, message: T) -> Result<(), SendError<T>> {
        match self.shared.room.acquire().await {
            // The receiver gives the place back when it takes the message.
            Ok(place) => place.forget(),
            Err(_closed) => return Err(SendError::Closed(message)),
        }
        self.push(message, Full::Refuses)
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
        let reader = {
            let mut queue = self.shared.lock();
            if queue.state == State::Open {
                queue.state = State::Disconnected;
            }
            queue.reader.take()
        };
        if let Some(reader) = reader {
            reader.wake();
        }
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
        let received = queue.messages.pop_front();
        if received.is_none() && queue.state == State::Open {
            queue.await_change(context);
            return Poll::Pending;
        }
        drop(queue);
        budget.made_progress();
        if P::SENDERS_WAIT && received.is_some() {
            self.shared.room.add_permits(1);
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
}

impl<T, P> Receiver<T, P> {
    /// How many messages were displaced by newer ones.
    pub fn dropped(&self) -> u64 {
        self.shared.n_dropped.load(Ordering::Relaxed)
    }
}

impl<T> Queue<T> {
    fn await_change(&mut self, context: &Context<'_>) {
        match &mut self.reader {
            Some(reader) => reader.clone_from(context.waker()),
            none => *none = Some(context.waker().clone()),
        }
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

#[cfg(test)]
mod tests;
