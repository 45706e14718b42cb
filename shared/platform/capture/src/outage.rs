//! Outage of a source: retries with a capped exponential back-off, reported as degraded health.

use message::ProcessState;
use service::{HealthCounters, Shutdown, monotonic_ns};
use std::sync::Arc;
use std::time::Duration;

/// Delay before the second attempt; doubled by each further one. Chosen.
const FIRST_DELAY: Duration = Duration::from_millis(100);
/// Longest delay between two attempts. Chosen: a camera that is back is used within a second.
const LONGEST_DELAY: Duration = Duration::from_secs(1);
/// Longest sleep between two checks of the shutdown request.
const NAP: Duration = Duration::from_millis(50);

/// Outage of a source or of shared memory while a process works on: it is logged when it
/// begins and when it ends, and health gives its present reason in between.
#[derive(Debug)]
pub struct Outage {
    health: Arc<HealthCounters>,
    shutdown: Shutdown,
    /// Present outage; `None` while all works.
    ongoing: Option<Ongoing>,
}

#[derive(Debug)]
struct Ongoing {
    began_ns: u64,
    delay: Duration,
}

impl Outage {
    /// Creates the record of a process without an outage.
    pub fn new(health: Arc<HealthCounters>, shutdown: Shutdown) -> Self {
        Self {
            health,
            shutdown,
            ongoing: None,
        }
    }

    /// Notes a failed attempt, and waits before the next one or until shutdown is requested.
    pub fn wait(&mut self, sentence: &str) {
        self.health.set_state(ProcessState::Degraded, sentence);
        let delay = if let Some(ongoing) = &mut self.ongoing {
            ongoing.delay = (2 * ongoing.delay).min(LONGEST_DELAY);
            ongoing.delay
        } else {
            tracing::warn!("{sentence}; trying again until it works");
            self.ongoing = Some(Ongoing {
                began_ns: monotonic_ns(),
                delay: FIRST_DELAY,
            });
            FIRST_DELAY
        };
        let end_ns = monotonic_ns() + delay.as_nanos() as u64;
        while monotonic_ns() < end_ns && !self.shutdown.is_requested() {
            std::thread::sleep(NAP);
            self.health.record_progress();
        }
    }

    /// `true` during an outage.
    pub fn is_ongoing(&self) -> bool {
        self.ongoing.is_some()
    }

    /// Ends the outage, if there is one, and restores the health of the process.
    pub fn end(&mut self, source_name: &str) {
        if let Some(ongoing) = self.ongoing.take() {
            let lasted_s = monotonic_ns().saturating_sub(ongoing.began_ns) as f64 * 1e-9;
            tracing::info!("{source_name} works again after {lasted_s:.1} s");
            self.health.set_state(ProcessState::Ready, "");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outage_degrades_health_with_its_present_reason_until_it_ends() {
        let health = Arc::new(HealthCounters::default());
        let (trigger, shutdown) = Shutdown::new();
        // Nothing is waited for in this test.
        trigger.request();
        let mut outage = Outage::new(health.clone(), shutdown);
        outage.end("the camera");
        assert_eq!(health.state().0, ProcessState::Starting);
        for reason in ["the folder is away", "the folder is empty"] {
            outage.wait(reason);
            let (state, note) = health.state();
            assert_eq!(
                (state, note.as_str()),
                (ProcessState::Degraded, Some(reason))
            );
        }
        outage.end("the camera");
        assert_eq!(health.state().0, ProcessState::Ready);
    }

    #[test]
    fn delay_doubles_up_to_its_limit_and_begins_anew_with_the_next_outage() {
        let (trigger, shutdown) = Shutdown::new();
        trigger.request();
        let mut outage = Outage::new(Arc::default(), shutdown);
        let delay_ms = |outage: &mut Outage| {
            outage.wait("away");
            outage.ongoing.as_ref().unwrap().delay.as_millis()
        };
        let delays: Vec<_> = (0..6).map(|_| delay_ms(&mut outage)).collect();
        assert_eq!(delays, [100, 200, 400, 800, 1000, 1000]);
        outage.end("the camera");
        assert_eq!(delay_ms(&mut outage), 100);
    }
}
