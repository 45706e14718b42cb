//! Process table: the latest health report of every process.

use channel::topic::ProcessHealth;
use channel::{Domain, Error, Received, Subscriber};
use message::{Health, ProcessKind, ProcessState};
use parking_lot::Mutex;
use scene_document::HealthDocument;
use service::monotonic_ns;
use std::collections::BTreeMap;

/// Largest age of a health report, nanoseconds; older processes are not listed.
const MAX_AGE_NS: u64 = 3_000_000_000;

/// Table of health reports, updated from the health topic on demand.
pub(crate) struct ProcessTable(Mutex<HealthSubscription>);

struct HealthSubscription {
    subscriber: Subscriber<ProcessHealth>,
    latest: BTreeMap<u32, Health>,
}

impl ProcessTable {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        let subscriber = Subscriber::polled(domain)?;
        Ok(Self(Mutex::new(HealthSubscription {
            subscriber,
            latest: BTreeMap::new(),
        })))
    }

    /// Receives waiting health reports; to be called about once a second.
    pub(crate) fn refresh(&self) {
        let mut inner = self.0.lock();
        let HealthSubscription { subscriber, latest } = &mut *inner;
        while let Ok(Received::Message(message)) = subscriber.receive() {
            // Copied out of shared memory first: what is checked is what is kept.
            for &health in message.items() {
                if ProcessKind::from_code(health.process).is_some() {
                    latest.insert(health.process, health);
                }
            }
        }
    }

    /// True if the sensor that has reported last is a camera, which simulates no arm.
    pub(crate) fn has_camera(&self) -> bool {
        self.refresh();
        newest_sensor(&self.0.lock().latest) == Some(ProcessKind::CAMERA)
    }

    /// True if an arm has a driver: one has reported, and has not ended in order since.
    pub(crate) fn expects_driver(&self) -> bool {
        self.refresh();
        expects_driver(&self.0.lock().latest)
    }

    /// Reports of all processes that are alive.
    pub(crate) fn reports(&self) -> Vec<HealthDocument> {
        self.refresh();
        let inner = self.0.lock();
        let now_ns = monotonic_ns();
        let is_recent = |health: &&Health| now_ns.saturating_sub(health.stamp_ns) < MAX_AGE_NS;
        inner
            .latest
            .values()
            .filter(is_recent)
            .filter_map(message::document::health)
            .collect()
    }
}

/// Camera or simulator, whichever has reported last.
fn newest_sensor(latest: &BTreeMap<u32, Health>) -> Option<ProcessKind> {
    let sensors = [ProcessKind::CAMERA, ProcessKind::SIMULATOR];
    let reported = sensors
        .into_iter()
        .filter_map(|kind| Some((latest.get(&kind.code())?.stamp_ns, kind)));
    let newest = reported.max_by_key(|(stamp_ns, _)| *stamp_ns);
    newest.map(|(_, kind)| kind)
}

fn expects_driver(latest: &BTreeMap<u32, Health>) -> bool {
    let report = latest.get(&ProcessKind::ARM.code());
    report.is_some_and(|report| report.state != ProcessState::Stopping.code())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn driver_is_expected_until_it_ends_in_order() {
        let report = |state: ProcessState| {
            let process = ProcessKind::ARM.code();
            let state = state.code();
            let health = Health {
                process,
                state,
                ..Health::default()
            };
            BTreeMap::from([(process, health)])
        };
        assert!(!expects_driver(&BTreeMap::new()));
        assert!(expects_driver(&report(ProcessState::Ready)));
        assert!(!expects_driver(&report(ProcessState::Stopping)));
    }

    #[test]
    fn sensor_is_the_one_that_has_reported_last() {
        let sensor = |stamps: &[(ProcessKind, u64)]| {
            let health = |(kind, stamp_ns): &(ProcessKind, u64)| {
                let health = Health {
                    process: kind.code(),
                    stamp_ns: *stamp_ns,
                    ..Health::default()
                };
                (kind.code(), health)
            };
            newest_sensor(&stamps.iter().map(health).collect())
        };
        let (camera, simulator) = (ProcessKind::CAMERA, ProcessKind::SIMULATOR);
        assert_eq!(sensor(&[(ProcessKind::MEMORY, 9)]), None);
        assert_eq!(sensor(&[(camera, 1)]), Some(camera));
        assert_eq!(sensor(&[(camera, 1), (simulator, 2)]), Some(simulator));
        assert_eq!(sensor(&[(camera, 3), (simulator, 2)]), Some(camera));
    }
}
