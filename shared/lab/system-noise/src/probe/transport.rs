//! Transport latency probe: one-way latency through shared memory as between the daemon's
//! processes (after iceoryx2's benchmarks).

mod private_domain;
mod stamped_sender;

use crate::samples::Samples;
use channel::topic::{CameraCloud, MAX_FRAME_POINTS, MemoryChanged};
use channel::{Domain, Error, Received, Subscriber};
use service::monotonic_ns;
use stamped_sender::{Arrivals, Stamped, StampedSender};
use std::hint::spin_loop;
use std::io;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Number of worker threads of the runtime, as in the daemon's processes.
const N_WORKERS: usize = 2;
/// Pause before each message to a blocking receiver, long enough for it to fall asleep.
const PAUSE_BLOCKING: Duration = Duration::from_micros(500);
/// Pause before each cloud to a polling receiver: two threads that never sleep would lose whole
/// time slices on a busy machine.
const PAUSE_CLOUD: Duration = Duration::from_micros(50);

/// Error of the transport probe.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// Failure of the shared-memory channel.
    #[error("the hop could not be measured: {0}")]
    Channel(#[from] Error),
    /// Thread that could not be started, or shared memory without a folder.
    #[error("the hop could not be measured, {attempt} failed: {source}")]
    System {
        /// Action that failed.
        attempt: &'static str,
        /// Cause reported by the operating system.
        source: io::Error,
    },
    /// Fewer than two cores for two spinning threads.
    #[error(
        "sender and receiver that never sleep need a core each, and there is one; give this process \
         two cores"
    )]
    OneCore,
}

/// Payload size of the probe's messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Payload {
    /// 24 bytes, as in the memory's announcements.
    Small,
    /// Cloud of 640 x 480 points, 4.9 MB, rewritten for each message.
    Cloud,
}

/// Waiting strategy of the receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReceiveMode {
    /// Busy polling without a pause.
    Polled,
    /// Blocking in a tokio runtime until woken.
    Blocking,
}

/// Measures one-way latencies between two threads through a domain of its own for `duration`:
/// from before the call to send until the receiver holds the message.
///
/// # Errors
/// If there are too few cores or too little shared memory, or the channel fails.
pub fn transport_latency(
    payload: Payload,
    receiver: ReceiveMode,
    duration: Duration,
) -> Result<Samples, TransportError> {
    let private = private_domain::PrivateDomain::new()?;
    let domain = private.join()?;
    let latencies_ns = match (payload, receiver) {
        (Payload::Small, ReceiveMode::Polled) => {
            polled::<MemoryChanged>(&domain, 1, duration, None)
        }
        (Payload::Small, ReceiveMode::Blocking) => blocking::<MemoryChanged>(&domain, 1, duration),
        (Payload::Cloud, ReceiveMode::Polled) => {
            polled::<CameraCloud>(&domain, MAX_FRAME_POINTS, duration, Some(PAUSE_CLOUD))
        }
        (Payload::Cloud, ReceiveMode::Blocking) => {
            blocking::<CameraCloud>(&domain, MAX_FRAME_POINTS, duration)
        }
    }?;
    let (name, meaning) = name_and_meaning(payload, receiver);
    Ok(Samples::new(name, meaning, latencies_ns))
}

/// Name and meaning of a transport probe.
pub fn name_and_meaning(payload: Payload, receiver: ReceiveMode) -> (&'static str, &'static str) {
    match (payload, receiver) {
        (Payload::Small, ReceiveMode::Polled) => (
            "hop, 24 B, polled",
            "one way through shared memory between two threads that never sleep",
        ),
        (Payload::Cloud, ReceiveMode::Polled) => (
            "hop, cloud, polled",
            "one way of a cloud of 4.9 MB, just written by a thread that had slept, to one that \
             never sleeps; reading it is not included",
        ),
        (Payload::Small, ReceiveMode::Blocking) => (
            "hop, 24 B, blocking",
            "one way through shared memory to a task that sleeps in a tokio runtime",
        ),
        (Payload::Cloud, ReceiveMode::Blocking) => (
            "hop, cloud, blocking",
            "one way of a cloud of 4.9 MB, just written, to such a task; reading it is not included",
        ),
    }
}

fn polled<T: Stamped>(
    domain: &Domain,
    n_items: usize,
    duration: Duration,
    pause: Option<Duration>,
) -> Result<Vec<u64>, TransportError> {
    let has_two_cores = crate::scheduling::usable_cores().is_none_or(|cores| cores.len() > 1);
    if !has_two_cores {
        return Err(TransportError::OneCore);
    }
    let sender = StampedSender::<T>::new(domain, duration)?;
    let subscriber = Subscriber::<T>::polled(domain)?;
    let arrivals = sender.arrivals.clone();
    let receiving =
        std::thread::Builder::new().spawn(move || receive_spinning(subscriber, &arrivals));
    let receiving = receiving.map_err(|source| TransportError::System {
        attempt: "starting a thread",
        source,
    })?;
    let arrivals = sender.arrivals.clone();
    let sent = sender.send_all(n_items, pause);
    let received = receiving.join();
    sent?;
    received.unwrap_or(Ok(()))?;
    Ok(arrivals.take_latencies())
}

fn receive_spinning<T: Stamped>(
    mut subscriber: Subscriber<T>,
    arrivals: &Arrivals,
) -> Result<(), Error> {
    while !arrivals.is_over.load(Ordering::Acquire) {
        match subscriber.receive()? {
            Received::Message(message) => arrivals.arrived(monotonic_ns(), T::stamp_ns(&message)),
            Received::Nothing | Received::BorrowLimitReached => spin_loop(),
        }
    }
    Ok(())
}

fn blocking<T: Stamped>(
    domain: &Domain,
    n_items: usize,
    duration: Duration,
) -> Result<Vec<u64>, TransportError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(N_WORKERS)
        .enable_all()
        .build();
    let runtime = runtime.map_err(|source| TransportError::System {
        attempt: "starting a runtime",
        source,
    })?;
    let within_runtime = runtime.enter();
    let sender = StampedSender::<T>::new(domain, duration)?;
    let mut subscriber = Subscriber::<T>::waiting(domain)?;
    drop(within_runtime);
    let arrivals = sender.arrivals.clone();
    let receiving: tokio::task::JoinHandle<Result<(), Error>> = runtime.spawn(async move {
        loop {
            let message = subscriber.next().await?;
            arrivals.arrived(monotonic_ns(), T::stamp_ns(&message));
        }
    });
    let arrivals = sender.arrivals.clone();
    let sent = sender.send_all(n_items, Some(PAUSE_BLOCKING));
    receiving.abort();
    let received = runtime.block_on(receiving);
    sent?;
    received.unwrap_or(Ok(()))?;
    Ok(arrivals.take_latencies())
}
