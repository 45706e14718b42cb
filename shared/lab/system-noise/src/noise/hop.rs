//! Transport latency probe: one-way latency through shared memory as between the daemon's
//! processes (after iceoryx2's benchmarks).

mod domain;
mod way;

use crate::samples::Samples;
use channel::topic::{CameraCloud, MAX_FRAME_POINTS, MemoryChanged};
use channel::{Domain, Error, Received, Subscriber};
use service::monotonic_ns;
use std::fmt;
use std::hint::spin_loop;
use std::io;
use std::sync::atomic::Ordering;
use std::time::Duration;
use way::{End, Stamped, Way};

/// Number of worker threads of the runtime, as in the daemon's processes.
const N_WORKERS: usize = 2;
/// Pause before each message to a blocking receiver, long enough for it to fall asleep.
const PAUSE_BLOCKING: Duration = Duration::from_micros(500);
/// Pause before each cloud to a polling receiver: two threads that never sleep would lose whole
/// time slices on a busy machine.
const PAUSE_CLOUD: Duration = Duration::from_micros(50);

/// Error of the transport probe.
#[derive(Debug)]
#[non_exhaustive]
pub enum HopError {
    /// The channel failed.
    Channel(Error),
    /// A thread could not be started, or shared memory has no folder.
    System {
        /// Attempted action.
        attempt: &'static str,
        /// Cause reported by the operating system.
        source: io::Error,
    },
    /// Two spinning threads need two cores.
    OneCore,
}

impl fmt::Display for HopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channel(error) => write!(f, "the hop could not be measured: {error}"),
            Self::System { attempt, source } => {
                write!(
                    f,
                    "the hop could not be measured, {attempt} failed: {source}"
                )
            }
            Self::OneCore => f.write_str(
                "sender and receiver that never sleep need a core each, and there is one; \
                 give this process two cores",
            ),
        }
    }
}

impl std::error::Error for HopError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Channel(error) => Some(error),
            Self::System { source, .. } => Some(source),
            Self::OneCore => None,
        }
    }
}

impl From<Error> for HopError {
    fn from(error: Error) -> Self {
        Self::Channel(error)
    }
}

/// Payload of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Payload {
    /// 24 bytes, as in the memory's announcements.
    Small,
    /// Cloud of 640 x 480 points, 4.9 MB, rewritten for each message.
    Cloud,
}

/// Waiting strategy of the receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Receiver {
    /// Polling without a pause.
    Polled,
    /// Blocking in a tokio runtime until woken.
    Blocking,
}

/// Measures one-way latencies between two threads through a domain of its own for `duration`:
/// from before the call to send until the receiver holds the message.
///
/// # Errors
/// If there are too few cores or too little shared memory, or the channel fails.
pub fn hop(payload: Payload, receiver: Receiver, duration: Duration) -> Result<Samples, HopError> {
    let place = domain::Place::new()?;
    let domain = place.join()?;
    let ways_ns = match (payload, receiver) {
        (Payload::Small, Receiver::Polled) => polled::<MemoryChanged>(&domain, 1, duration, None),
        (Payload::Small, Receiver::Blocking) => blocking::<MemoryChanged>(&domain, 1, duration),
        (Payload::Cloud, Receiver::Polled) => {
            polled::<CameraCloud>(&domain, MAX_FRAME_POINTS, duration, Some(PAUSE_CLOUD))
        }
        (Payload::Cloud, Receiver::Blocking) => {
            blocking::<CameraCloud>(&domain, MAX_FRAME_POINTS, duration)
        }
    }?;
    let (name, meaning) = names(payload, receiver);
    Ok(Samples::new(name, meaning, ways_ns))
}

/// Name and meaning of a transport probe.
pub fn names(payload: Payload, receiver: Receiver) -> (&'static str, &'static str) {
    match (payload, receiver) {
        (Payload::Small, Receiver::Polled) => (
            "hop, 24 B, polled",
            "one way through shared memory between two threads that never sleep",
        ),
        (Payload::Cloud, Receiver::Polled) => (
            "hop, cloud, polled",
            "one way of a cloud of 4.9 MB, just written by a thread that had slept, to one that \
             never sleeps; reading it is not included",
        ),
        (Payload::Small, Receiver::Blocking) => (
            "hop, 24 B, blocking",
            "one way through shared memory to a task that sleeps in a tokio runtime",
        ),
        (Payload::Cloud, Receiver::Blocking) => (
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
) -> Result<Vec<u64>, HopError> {
    let has_two_cores = crate::scheduling::usable_cores().is_none_or(|cores| cores.len() > 1);
    if !has_two_cores {
        return Err(HopError::OneCore);
    }
    let way = Way::<T>::new(domain, duration)?;
    let subscriber = Subscriber::<T>::polled(domain)?;
    let end = way.end.clone();
    let receiving = std::thread::Builder::new().spawn(move || receive_spinning(subscriber, &end));
    let receiving = receiving.map_err(|source| HopError::System {
        attempt: "starting a thread",
        source,
    })?;
    let end = way.end.clone();
    let sent = way.send_all(n_items, pause);
    let received = receiving.join();
    sent?;
    received.unwrap_or(Ok(()))?;
    Ok(end.take_ways())
}

fn receive_spinning<T: Stamped>(mut subscriber: Subscriber<T>, end: &End) -> Result<(), Error> {
    while !end.is_over.load(Ordering::Acquire) {
        match subscriber.receive()? {
            Received::Message(message) => end.arrived(monotonic_ns(), T::stamp_ns(&message)),
            Received::Nothing | Received::HoldsAll => spin_loop(),
        }
    }
    Ok(())
}

fn blocking<T: Stamped>(
    domain: &Domain,
    n_items: usize,
    duration: Duration,
) -> Result<Vec<u64>, HopError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(N_WORKERS)
        .enable_all()
        .build();
    let runtime = runtime.map_err(|source| HopError::System {
        attempt: "starting a runtime",
        source,
    })?;
    let within_runtime = runtime.enter();
    let way = Way::<T>::new(domain, duration)?;
    let mut subscriber = Subscriber::<T>::waiting(domain)?;
    drop(within_runtime);
    let end = way.end.clone();
    let receiving: tokio::task::JoinHandle<Result<(), Error>> = runtime.spawn(async move {
        loop {
            let message = subscriber.next().await?;
            end.arrived(monotonic_ns(), T::stamp_ns(&message));
        }
    });
    let end = way.end.clone();
    let sent = way.send_all(n_items, Some(PAUSE_BLOCKING));
    receiving.abort();
    let received = runtime.block_on(receiving);
    sent?;
    received.unwrap_or(Ok(()))?;
    Ok(end.take_ways())
}
