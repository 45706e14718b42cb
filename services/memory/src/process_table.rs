//! The latest health of every process.

use channel::topic::ProcessHealth;
use channel::{Domain, Error, Received, Subscriber};
use message::control::ProcessReport;
use message::{Health, ProcessKind};
use service::monotonic_ns;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// A process that has said nothing for this long is not listed.
const MAX_AGE_NS: u64 = 3_000_000_000;

/// Reads the health topic when it is asked for.
pub(crate) struct ProcessTable(Mutex<Inner>);

struct Inner {
    subscriber: Subscriber<ProcessHealth>,
    latest: BTreeMap<u32, Health>,
}

impl ProcessTable {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        let subscriber = Subscriber::polled(domain)?;
        Ok(Self(Mutex::new(Inner {
            subscriber,
            latest: BTreeMap::new(),
        })))
    }

    /// Takes what has been reported; to be called about once a second.
    pub(crate) fn refresh(&self) {
        let mut inner = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        while let Ok(Received::Message(message)) = inner.subscriber.receive() {
            for health in message.items() {
                if ProcessKind::from_code(health.process).is_some() {
                    inner.latest.insert(health.process, *health);
                }
            }
        }
    }

    /// Everybody who has reported lately.
    pub(crate) fn reports(&self) -> Vec<ProcessReport> {
        self.refresh();
        let inner = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let now_ns = monotonic_ns();
        let is_recent = |health: &&Health| now_ns.saturating_sub(health.stamp_ns) < MAX_AGE_NS;
        inner
            .latest
            .values()
            .filter(is_recent)
            .filter_map(ProcessReport::new)
            .collect()
    }
}
