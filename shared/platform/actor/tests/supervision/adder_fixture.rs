//! Test actor that adds numbers and fails on request.

use std::fmt;
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use actor::{
    Actor, Config, DropOldest, Events, Flow, LifecycleEvent, Placement, Progress, Restart,
    RestartPolicy,
};
use tokio::time::timeout;

/// Watchdog of a test, far beyond any healthy run. Under a paused clock it fires as
/// soon as all tasks wait: a deadlock is found at once.
pub(crate) const WATCHDOG: Duration = Duration::from_secs(600);

/// Actor whose state is the sum of its messages.
pub(crate) struct Adder<P = DropOldest> {
    total: u64,
    shared: Arc<AdderCounters>,
    policy: PhantomData<fn() -> P>,
}

/// Counters shared by all adders.
#[derive(Debug, Default)]
pub(crate) struct AdderCounters {
    pub(crate) started: AtomicUsize,
    pub(crate) stopped: AtomicUsize,
    pub(crate) dropped: AtomicUsize,
    /// Number of further actor starts that fail.
    pub(crate) bad_starts: AtomicUsize,
}

#[derive(Debug)]
pub(crate) enum Order {
    Add(u64),
    /// Adds the number, holding a resource meanwhile.
    AddHolding(u64, Arc<()>),
    /// Adds the number, then panics.
    Panic(u64),
    /// Adds the number, then fails.
    Fail(u64),
    /// Adds the number, then stops itself.
    Finish(u64),
    /// Signals its begin, then hangs until the gate is dropped; adds one.
    Hang(mpsc::Sender<()>, mpsc::Receiver<()>),
    /// Makes the actor's `stop` panic.
    SpoilStop,
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Refused;

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the adder refuses")
    }
}

impl std::error::Error for Refused {}

const SPOILT: u64 = u64::MAX;

impl<P: actor::mailbox::Overflow> Actor for Adder<P> {
    type Message = Order;
    type Reply = u64;
    type Checkpoint = u64;
    type Context = AdderCounters;
    type Error = Refused;
    type Overflow = P;

    fn start(shared: &Arc<AdderCounters>, total: u64) -> Result<Self, Refused> {
        let take_one = |n: usize| n.checked_sub(1);
        let counter = &shared.bad_starts;
        if counter
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take_one)
            .is_ok()
        {
            return Err(Refused);
        }
        shared.started.fetch_add(1, Ordering::Relaxed);
        Ok(Self {
            total,
            shared: Arc::clone(shared),
            policy: PhantomData,
        })
    }

    #[expect(clippy::panic, reason = "panics are under test")]
    fn handle(&mut self, order: Order, _progress: &Progress) -> Result<Flow<u64>, Refused> {
        match order {
            Order::Add(n) => self.total += n,
            Order::AddHolding(n, resource) => {
                self.total += n;
                drop(resource);
            }
            Order::Panic(n) => {
                self.total += n;
                panic!("at {}", self.total);
            }
            Order::Fail(n) => {
                self.total += n;
                return Err(Refused);
            }
            Order::Finish(n) => {
                self.total += n;
                return Ok(Flow::Stop(self.total));
            }
            Order::Hang(begun, gate) => {
                let _ = begun.send(());
                let _ = gate.recv();
                self.total += 1;
            }
            Order::SpoilStop => self.total = SPOILT,
        }
        Ok(Flow::Continue(self.total))
    }

    fn checkpoint(&self) -> u64 {
        self.total
    }

    fn stop(&mut self) {
        assert!(self.total != SPOILT, "spoilt");
        self.shared.stopped.fetch_add(1, Ordering::Relaxed);
    }
}

impl<P> Drop for Adder<P> {
    fn drop(&mut self) {
        self.shared.dropped.fetch_add(1, Ordering::Relaxed);
    }
}

pub(crate) fn count(n: usize) -> NonZeroUsize {
    NonZeroUsize::new(n).expect("tests count from one")
}

/// Restart policy: 50 ms doubling to 2 s, at most 30 in 60 s.
pub(crate) fn usual_policy() -> RestartPolicy {
    RestartPolicy::new(
        30,
        Duration::from_secs(60),
        Duration::from_millis(50),
        Duration::from_secs(2),
    )
    .expect("the usual policy is valid")
}

pub(crate) fn config(restart: Restart, placement: Placement) -> Config {
    Config {
        restart,
        policy: usual_policy(),
        placement,
        mailbox_capacity: count(4),
        shutdown: Duration::from_secs(5),
        event_capacity: count(4096),
    }
}

/// Awaits a future under the watchdog.
pub(crate) async fn soon<T>(future: impl Future<Output = T>) -> T {
    timeout(WATCHDOG, future).await.expect("the test hangs")
}

/// Next supervisor event; `None` after the last.
pub(crate) async fn next(events: &mut Events<u64>) -> Option<LifecycleEvent<u64>> {
    soon(events.recv()).await
}

/// Log sentences of the next `n` supervisor events.
pub(crate) async fn lines(events: &mut Events<u64>, n: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for _ in 0..n {
        lines.extend(next(events).await.map(|event| event.to_string()));
    }
    lines
}
