//! Reload task of a process: SIGHUP, check, change of the live configuration, report.

use super::live_config::LiveConfig;
use super::reload_record::ReloadRecordPublisher;
use super::{ReloadPlan, log_reload};
use crate::controlling_terminal::ControllingTerminal;
use crate::service_manager::ReloadNotice;
use crate::{
    ConfigError, Configuration, Failure, HealthCounters, Shutdown, ShutdownTrigger, monotonic_ns,
};
use channel::Domain;
use control_protocol::ReloadReport;
use message::{ProcessKind, ProcessState};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::watch;

/// Period of looks at the controlling terminal.
const LOOK_PERIOD: Duration = Duration::from_secs(1);

/// Places of the configuration of a process.
#[derive(Debug, Clone)]
pub(crate) struct ConfigPlace {
    /// File of `--config`.
    pub(crate) given: Option<PathBuf>,
    /// Data folder.
    pub(crate) home: PathBuf,
}

/// Reload task of one process.
pub(crate) struct Reloader<C, F> {
    process: ProcessKind,
    place: ConfigPlace,
    /// Configuration that the process works with.
    running: Configuration,
    check: F,
    sender: watch::Sender<Arc<C>>,
    record: ReloadRecordPublisher,
    hang_ups: Signal,
    terminal: ControllingTerminal,
    health: Arc<HealthCounters>,
}

impl<C, F: FnMut(&Configuration) -> Result<C, Failure>> Reloader<C, F> {
    /// Begins to listen for SIGHUP; also returns the live configuration of the process.
    ///
    /// # Errors
    /// When signals cannot be received, or the run folder cannot be written.
    pub(crate) fn new(
        domain: &Domain,
        process: ProcessKind,
        place: ConfigPlace,
        parent: Option<u32>,
        started: (Configuration, C, F),
        health: Arc<HealthCounters>,
    ) -> Result<(Self, LiveConfig<C>), Failure> {
        let hang_ups = signal(SignalKind::hangup())
            .map_err(|error| Failure::general(format!("could not listen for SIGHUP: {error}")))?;
        let (running, config, check) = started;
        let (sender, live) = LiveConfig::new(config);
        let reloader = Self {
            process,
            place,
            running,
            check,
            sender,
            record: ReloadRecordPublisher::new(domain, Some(process), parent)?,
            hang_ups,
            terminal: ControllingTerminal::new(),
            health,
        };
        Ok((reloader, live))
    }

    /// Reloads at each SIGHUP until shutdown, which it requests when the terminal of the process
    /// was closed.
    pub(crate) async fn run(mut self, trigger: ShutdownTrigger, shutdown: Shutdown) {
        let mut looks = tokio::time::interval(LOOK_PERIOD);
        // Who changed the files since they were read could not ask this process to reload.
        if self.read().is_ok_and(|found| found != self.running) {
            tokio::task::block_in_place(|| self.reload());
        }
        loop {
            let is_hang_up = tokio::select! {
                () = shutdown.requested() => return,
                _ = looks.tick() => false,
                received = self.hang_ups.recv() => received.is_some(),
            };
            if is_hang_up {
                self.terminal.hang_up();
            }
            if self.terminal.was_closed() {
                tracing::info!("stopping: the terminal was closed");
                return trigger.request();
            }
            if is_hang_up {
                // Files may be slow to read.
                tokio::task::block_in_place(|| self.reload());
            }
        }
    }

    fn read(&self) -> Result<Configuration, ConfigError> {
        Configuration::find(self.place.given.as_deref(), &self.place.home)
    }

    fn reload(&mut self) {
        let began_ns = monotonic_ns();
        // systemd must not take the end of a reload for readiness.
        let is_ready = self.health.state().0 != ProcessState::Starting;
        let notice = is_ready.then(ReloadNotice::begin);
        let mut report = self.record.report();
        if let Err(failure) = self.try_reload(&mut report) {
            report.refused = Some(failure.sentence);
        }
        log_reload(&report);
        self.record.publish(began_ns, report);
        drop(notice);
    }

    /// Checks all of the configuration before it applies any of it.
    fn try_reload(&mut self, report: &mut ReloadReport) -> Result<(), Failure> {
        let found = self.read()?;
        (self.check)(&found)?;
        let plan = ReloadPlan::new(&self.running, &found, self.process.word());
        let config = (self.check)(&plan.effective)?;
        self.running = plan.effective;
        self.sender.send_replace(Arc::new(config));
        report.applied = plan.applied;
        report.needs_restart = plan.needs_restart;
        Ok(())
    }
}
