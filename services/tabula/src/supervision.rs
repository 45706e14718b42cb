//! Supervision of the daemon's processes: children that are restarted when they end or hang.
//!
//! One sick process does not stop the others. It is restarted for ever, with a delay that
//! grows; `tabula status` names it.

mod boot_clock;
mod child;
mod config;
mod health_feed;
mod process_record;
mod program;
mod progress_watch;
mod restart_streak;
mod systemd_units;

pub(crate) use child::Child;
pub(crate) use config::SupervisionConfig;
#[cfg(test)]
pub(crate) use process_record::Supervisor;
pub(crate) use process_record::{ProcessRecord, RecordedState, read as read_records};
pub(crate) use program::{ProcessCommand, check, common_arguments};

use boot_clock::time_since_boot;
use channel::{Domain, Error};
use health_feed::HealthFeed;
use process_record::RecordPublisher;
use service::Failure;
use std::time::{Duration, Instant};

/// Time that the children get to stop; the rest of the promised 5 s is for killing them.
const STOP_TIMEOUT: Duration = Duration::from_secs(4);
/// Polling period of stopping children. Chosen.
const STOP_POLL_PERIOD: Duration = Duration::from_millis(20);

/// Supervisor of the daemon's processes.
pub(crate) struct Supervision {
    config: SupervisionConfig,
    children: Vec<Child>,
    feed: HealthFeed,
    record: RecordPublisher,
}

impl Supervision {
    /// Prepares the supervision of processes in a domain.
    ///
    /// # Errors
    /// When the topic of health reports or the run folder cannot be used.
    pub(crate) fn new(domain: &Domain, config: SupervisionConfig) -> Result<Self, Error> {
        Ok(Self {
            config,
            children: Vec::new(),
            feed: HealthFeed::new(domain)?,
            record: RecordPublisher::new(domain)?,
        })
    }

    /// Starts a process with its arguments.
    ///
    /// # Errors
    /// When its program is not there or cannot be started.
    pub(crate) fn start(&mut self, command: ProcessCommand) -> Result<(), Failure> {
        let child = Child::start(command, self.config, time_since_boot())?;
        self.children.push(child);
        Ok(())
    }

    /// Polls all processes once, and publishes their states.
    ///
    /// # Errors
    /// When a process cannot run at all: see [`Child::supervise`].
    pub(crate) fn poll(&mut self) -> Result<(), Failure> {
        let now = time_since_boot();
        let is_heard = self.feed.refresh(now);
        for child in &mut self.children {
            child.supervise(is_heard.then_some(&self.feed), now)?;
        }
        let pids: Vec<u32> = self.children.iter().filter_map(Child::pid).collect();
        self.feed.retain(&pids);
        self.record
            .update(self.children.iter().map(Child::record).collect());
        Ok(())
    }

    /// Replaces the configuration, and passes the request to reload on to all processes.
    pub(crate) fn reload(&mut self, config: SupervisionConfig) {
        self.config = config;
        for child in &mut self.children {
            child.set_config(config);
            child.request_reload();
        }
    }

    /// All processes in the order of their start.
    pub(crate) fn children(&self) -> &[Child] {
        &self.children
    }

    /// Stops the sensor process first, then the consumers of its frames.
    pub(crate) fn stop(mut self) {
        // Nothing is expected to run any more.
        drop(self.record);
        for child in self.children.iter().rev() {
            child.ask_to_stop();
        }
        let deadline = Instant::now() + STOP_TIMEOUT;
        while Instant::now() < deadline && !self.children.iter_mut().all(Child::has_ended) {
            std::thread::sleep(STOP_POLL_PERIOD);
        }
        self.children.iter_mut().for_each(Child::kill);
    }
}
