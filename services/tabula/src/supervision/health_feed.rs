//! Health feed: the newest health report of every process id, from the topic `health`.

use super::progress_watch::{BootTime, ProgressReport};
use channel::topic::ProcessHealth;
use channel::{Domain, Error, Received, Subscriber};
use message::ProcessState;
use std::collections::BTreeMap;
use std::time::Duration;

/// Period in which a lost subscription is tried again. Chosen.
const RETRY_PERIOD: Duration = Duration::from_secs(1);

/// Subscription to the health reports, renewed when it is lost.
pub(crate) struct HealthFeed {
    domain: Domain,
    subscriber: Option<Subscriber<ProcessHealth>>,
    /// Instant of the next attempt to subscribe.
    retry: BootTime,
    latest: BTreeMap<u32, ProgressReport>,
}

impl HealthFeed {
    /// Subscribes to the topic.
    ///
    /// # Errors
    /// When shared memory fails, or the topic is of another version.
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            domain: domain.clone(),
            subscriber: Some(Subscriber::polled(domain)?),
            retry: BootTime::ZERO,
            latest: BTreeMap::new(),
        })
    }

    /// Takes the waiting reports; `false` when none can be received at present.
    pub(crate) fn refresh(&mut self, now: BootTime) -> bool {
        let received = match &mut self.subscriber {
            Some(subscriber) => receive_all(subscriber, &mut self.latest),
            None if now < self.retry => return false,
            None => Subscriber::polled(&self.domain).map(|subscriber| {
                tracing::info!("the health reports of the processes are received again");
                self.subscriber = Some(subscriber);
            }),
        };
        let Err(error) = received else {
            return self.subscriber.is_some();
        };
        if self.subscriber.take().is_some() {
            tracing::warn!(
                "no health reports are received, so that a process that hangs is not found, until \
                 the topic can be read again: {error}"
            );
        }
        self.retry = now + RETRY_PERIOD;
        false
    }

    /// Newest report of a process id.
    pub(crate) fn report(&self, pid: u32) -> Option<ProgressReport> {
        self.latest.get(&pid).copied()
    }

    /// Forgets the reports of all other process ids, which may be given to another process.
    pub(crate) fn retain(&mut self, pids: &[u32]) {
        self.latest.retain(|pid, _| pids.contains(pid));
    }
}

fn receive_all(
    subscriber: &mut Subscriber<ProcessHealth>,
    latest: &mut BTreeMap<u32, ProgressReport>,
) -> Result<(), Error> {
    while let Received::Message(message) = subscriber.receive()? {
        for health in message.items() {
            let report = ProgressReport {
                counter: health.progress,
                is_starting: health.state == ProcessState::Starting.code(),
            };
            latest.insert(health.pid, report);
        }
    }
    Ok(())
}
