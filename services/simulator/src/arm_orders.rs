//! Orders of the camera to the arm's loop, which owns the simulated world: advance, end, close.

use capture::SourceError;
use crossbeam::channel::{Receiver, Sender, bounded, unbounded};
use simulated_world::World;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{JoinHandle, Thread};

/// World at the end of a frame interval, for rendering.
#[derive(Debug, Clone)]
pub(crate) struct Snapshot {
    pub(crate) world: Arc<World>,
    /// Number of frames up to this one.
    pub(crate) frame: u64,
}

/// Order of the camera.
pub(crate) enum Order {
    /// Simulate the next frame interval, and answer with the world at its end.
    Advance {
        answer: Sender<Snapshot>,
        /// Thread to be woken when the world changes.
        camera: Thread,
    },
    /// The interval ends at this time, monotonic, nanoseconds.
    EndsAt(u64),
    /// Publish the states of the arm up to the end of the interval, at `end_ns`.
    Close {
        end_ns: u64,
        answer: Sender<Result<(), channel::Error>>,
    },
}

/// World that has changed since it was handed out, by a command to the arm.
#[derive(Debug, Clone, Default)]
pub(crate) struct ChangedWorld(Arc<Mutex<Option<Snapshot>>>);

impl ChangedWorld {
    /// Puts a snapshot in the place of an older one.
    pub(crate) fn put(&self, snapshot: Option<Snapshot>) {
        let mut place = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let _older = std::mem::replace(&mut *place, snapshot);
        drop(place);
    }

    /// Takes the snapshot, if there is a newer one.
    pub(crate) fn take(&self) -> Option<Snapshot> {
        let mut place = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        place.take()
    }
}

/// Receiving end, in the arm's loop.
pub(crate) struct Orders {
    pub(crate) received: Receiver<Order>,
    pub(crate) changed: ChangedWorld,
}

/// Sending end, in the thread of the camera. The loop ends with it.
pub(crate) struct OrderSender {
    orders: Option<Sender<Order>>,
    changed: ChangedWorld,
    thread: Option<JoinHandle<()>>,
}

impl OrderSender {
    /// Starts the arm's loop on a thread of its own.
    ///
    /// # Errors
    /// When the thread cannot be started.
    pub(crate) fn start(
        arm_loop: impl FnOnce(Orders) + Send + 'static,
    ) -> Result<Self, std::io::Error> {
        let (sender, received) = unbounded();
        let changed = ChangedWorld::default();
        let orders = Orders {
            received,
            changed: changed.clone(),
        };
        let thread = std::thread::Builder::new()
            .name("arm".into())
            .spawn(move || arm_loop(orders))?;
        Ok(Self {
            orders: Some(sender),
            changed,
            thread: Some(thread),
        })
    }

    /// Lets the next frame interval be simulated; returns the world at its end.
    pub(crate) fn advance(&self) -> Result<Snapshot, SourceError> {
        let (answer, answered) = bounded(1);
        self.send(Order::Advance {
            answer,
            camera: std::thread::current(),
        })?;
        answered.recv().map_err(|_| has_ended())
    }

    /// Says when the interval ends, monotonic, nanoseconds.
    pub(crate) fn ends_at(&self, end_ns: u64) -> Result<(), SourceError> {
        self.send(Order::EndsAt(end_ns))
    }

    /// The world, if a command has changed it.
    pub(crate) fn changed(&self) -> Option<Snapshot> {
        self.changed.take()
    }

    /// Waits until all states of the arm up to the end of the interval are published.
    pub(crate) fn close(&self, end_ns: u64) -> Result<(), SourceError> {
        let (answer, answered) = bounded(1);
        self.send(Order::Close { end_ns, answer })?;
        Ok(answered.recv().map_err(|_| has_ended())??)
    }

    fn send(&self, order: Order) -> Result<(), SourceError> {
        let orders = self.orders.as_ref().ok_or_else(has_ended)?;
        orders.send(order).map_err(|_| has_ended())?;
        if let Some(thread) = &self.thread {
            thread.thread().unpark();
        }
        Ok(())
    }
}

impl Drop for OrderSender {
    fn drop(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A panic has been logged, and the process ends anyway.
            let _ = thread.join();
        }
    }
}

fn has_ended() -> SourceError {
    SourceError::Unusable("the loop of the simulated arm has ended; see the log above".into())
}
