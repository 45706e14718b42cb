//! Sender and receiver of time-stamped messages for the transport probe.

use channel::topic::{CameraCloud, MemoryChanged, Topic};
use channel::{Domain, Error, Loan, Publisher, SharedMessage};
use message::CloudPoint;
use parking_lot::Mutex;
use service::monotonic_ns;
use std::hint::spin_loop;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Maximum number of messages in one probe.
const MESSAGES_MAX: usize = 10_000;

/// Topic whose messages can carry a send time stamp.
pub(super) trait Stamped: Topic {
    /// Writes all items of a message to be sent.
    fn fill(loan: &mut Loan<Self>, number: u64)
    where
        Self: Sized;
    /// Writes the send time stamp.
    fn stamp(loan: &mut Loan<Self>, now_ns: u64)
    where
        Self: Sized;
    /// Send time stamp of a message, monotonic clock, ns.
    fn stamp_ns(message: &SharedMessage<Self>) -> u64
    where
        Self: Sized;
}

impl Stamped for MemoryChanged {
    fn fill(_: &mut Loan<Self>, _: u64) {}

    fn stamp(loan: &mut Loan<Self>, now_ns: u64) {
        for item in loan.items_mut() {
            item.sequence = now_ns;
        }
    }

    fn stamp_ns(message: &SharedMessage<Self>) -> u64 {
        message.items().first().map_or(0, |item| item.sequence)
    }
}

impl Stamped for CameraCloud {
    fn fill(loan: &mut Loan<Self>, number: u64) {
        loan.items_mut().fill(CloudPoint {
            x: 0.0,
            y: 0.0,
            z: 1.0,
            argb: number as u32,
        });
    }

    fn stamp(loan: &mut Loan<Self>, now_ns: u64) {
        loan.header_mut().published_stamp_ns = now_ns;
    }

    fn stamp_ns(message: &SharedMessage<Self>) -> u64 {
        message.header().published_stamp_ns
    }
}

/// Latencies recorded by the probe's receiver.
#[derive(Debug, Default)]
pub(super) struct Arrivals {
    /// Flag that is set when the sender is done.
    pub(super) is_over: AtomicBool,
    n_received: AtomicU64,
    latencies_ns: Mutex<Vec<u64>>,
}

impl Arrivals {
    /// Records a message. The sender waits for it before it sends the next one, so the recording
    /// is not part of a measured latency.
    pub(super) fn arrived(&self, now_ns: u64, stamp_ns: u64) {
        let mut latencies_ns = self.latencies_ns.lock();
        latencies_ns.push(now_ns.saturating_sub(stamp_ns));
        drop(latencies_ns);
        self.n_received.fetch_add(1, Ordering::Release);
    }

    /// Measured one-way latencies, ns.
    pub(super) fn take_latencies(&self) -> Vec<u64> {
        std::mem::take(&mut *self.latencies_ns.lock())
    }
}

/// Sending side; the receiver is notified when it is dropped.
#[derive(Debug)]
pub(super) struct StampedSender<T: Stamped> {
    pub(super) arrivals: Arc<Arrivals>,
    publisher: Publisher<T>,
    deadline: Instant,
}

impl<T: Stamped> StampedSender<T> {
    pub(super) fn new(domain: &Domain, duration: Duration) -> Result<Self, Error> {
        let arrivals = Arrivals {
            latencies_ns: Mutex::new(Vec::with_capacity(MESSAGES_MAX)),
            ..Arrivals::default()
        };
        Ok(Self {
            arrivals: Arc::new(arrivals),
            publisher: Publisher::new(domain)?,
            deadline: Instant::now() + duration,
        })
    }

    /// Sends messages one by one until the deadline, each after the previous one has arrived and
    /// after the pause, if any.
    pub(super) fn send_all(mut self, n_items: usize, pause: Option<Duration>) -> Result<(), Error> {
        for number in 1..=MESSAGES_MAX as u64 {
            let mut loan = self.publisher.loan(n_items)?;
            T::fill(&mut loan, number);
            T::stamp(&mut loan, monotonic_ns());
            self.publisher.send(loan)?;
            if !self.wait_for(number, pause) {
                break;
            }
        }
        Ok(())
    }

    /// `true` if `n_received` messages have arrived before the deadline.
    fn wait_for(&self, n_received: u64, pause: Option<Duration>) -> bool {
        loop {
            match pause {
                Some(pause) => std::thread::sleep(pause),
                None => spin_loop(),
            }
            if Instant::now() >= self.deadline {
                return false;
            }
            if self.arrivals.n_received.load(Ordering::Acquire) >= n_received {
                return true;
            }
        }
    }
}

impl<T: Stamped> Drop for StampedSender<T> {
    fn drop(&mut self) {
        self.arrivals.is_over.store(true, Ordering::Release);
    }
}
