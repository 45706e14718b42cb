//! Reload of the configuration by `tabula run`: a check of all of it, its own section, and the
//! request to its children.

use crate::arguments::RunArguments;
use crate::daemon::checked_processes;
use crate::supervision::{Supervision, SupervisionConfig};
use channel::Domain;
use command_line::HangUps;
use control_protocol::{KeyChange, ReloadReport};
use service::{
    CommonArguments, Configuration, ControllingTerminal, Failure, ReloadNotice, ReloadPlan,
    ReloadRecordPublisher, log_reload, monotonic_ns,
};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Period of looks at the controlling terminal.
const LOOK_PERIOD: Duration = Duration::from_secs(1);
/// Key that `tabula run` reads, too: it chooses between camera and simulator.
const SOURCE_KEY: &str = "camera.source";

/// Reload of a running daemon. The check of all processes runs on a thread of its own, so that the
/// supervision goes on.
pub(crate) struct DaemonReload {
    domain: Domain,
    hang_ups: HangUps,
    terminal: ControllingTerminal,
    next_look: Instant,
    common: CommonArguments,
    run: RunArguments,
    /// Configuration at the start.
    started: Configuration,
    /// Configuration that the supervision works with.
    running: Configuration,
    record: ReloadRecordPublisher,
    is_requested: bool,
    check: Option<RunningCheck>,
}

/// Check of a reload that is under way.
struct RunningCheck {
    began_ns: u64,
    outcome: Receiver<Result<Configuration, Failure>>,
    _notice: ReloadNotice,
}

impl DaemonReload {
    /// Reload at SIGHUP, for a daemon that was started with a configuration and arguments.
    ///
    /// # Errors
    /// When the run folder cannot be used.
    pub(crate) fn new(
        domain: &Domain,
        hang_ups: HangUps,
        started: Configuration,
        (common, run): (&CommonArguments, &RunArguments),
    ) -> Result<Self, Failure> {
        Ok(Self {
            domain: domain.clone(),
            hang_ups,
            terminal: ControllingTerminal::new(),
            next_look: Instant::now(),
            common: common.clone(),
            run: run.clone(),
            running: started.clone(),
            started,
            record: ReloadRecordPublisher::new(domain, None, None)?,
            is_requested: false,
            check: None,
        })
    }

    /// Domain of the daemon.
    pub(crate) fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Takes note of a SIGHUP; true when it came with the end of the terminal, and is no request.
    pub(crate) fn is_terminal_closed(&mut self) -> bool {
        if self.hang_ups.take() {
            self.is_requested = true;
            self.terminal.hang_up();
        }
        if !self.is_requested && Instant::now() < self.next_look {
            return false;
        }
        self.next_look = Instant::now() + LOOK_PERIOD;
        self.terminal.was_closed()
    }

    /// Begins a requested reload, and ends one whose check is done.
    pub(crate) fn poll(&mut self, supervision: &mut Supervision) {
        if let Some(outcome) = self.check.as_ref().and_then(RunningCheck::take_outcome) {
            self.finish(outcome, supervision);
        }
        if self.check.is_none() && std::mem::take(&mut self.is_requested) {
            self.check = Some(RunningCheck::begin(&self.common, &self.run));
        }
    }

    fn finish(&mut self, outcome: Result<Configuration, Failure>, supervision: &mut Supervision) {
        let Some(check) = self.check.take() else {
            return;
        };
        let mut report = self.record.report();
        let applied = outcome.and_then(|found| self.apply(&found, &mut report));
        let config = match applied {
            Ok(config) => Some(config),
            Err(failure) => {
                report.refused = Some(failure.sentence);
                None
            }
        };
        log_reload(&report);
        self.record.publish(check.began_ns, report);
        if let Some(config) = config {
            supervision.reload(config);
        }
    }

    /// New configuration of the supervision, with the changes in the report.
    fn apply(
        &mut self,
        found: &Configuration,
        report: &mut ReloadReport,
    ) -> Result<SupervisionConfig, Failure> {
        let plan = ReloadPlan::new(&self.running, found, "run");
        let config = SupervisionConfig::new(&plan.effective)?;
        report.applied = plan.applied;
        report.needs_restart = plan.needs_restart;
        report.needs_restart.extend(self.other_source(found));
        self.running = plan.effective;
        Ok(config)
    }

    /// Change of the source, which a simulator would not report.
    fn other_source(&self, found: &Configuration) -> Option<KeyChange> {
        if self.run.source().is_some() {
            return None;
        }
        let plan = ReloadPlan::new(&self.started, found, "camera");
        let is_source = |change: &KeyChange| change.key == SOURCE_KEY;
        let was_simulated = self
            .started
            .effective("camera", "source")
            .is_none_or(|source| source.as_str().is_some_and(|s| s.starts_with("simulation")));
        plan.needs_restart
            .into_iter()
            .find(|change| was_simulated && is_source(change))
    }
}

impl RunningCheck {
    /// Begins to check all of the configuration.
    fn begin(common: &CommonArguments, run: &RunArguments) -> Self {
        let began_ns = monotonic_ns();
        let (sender, outcome) = channel();
        let (common, run) = (common.clone(), run.clone());
        std::thread::spawn(move || {
            let _ = sender.send(check(&common, &run));
        });
        Self {
            began_ns,
            outcome,
            _notice: ReloadNotice::begin(),
        }
    }

    fn take_outcome(&self) -> Option<Result<Configuration, Failure>> {
        match self.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(Failure::general("the check has failed; see the log")))
            }
        }
    }
}

fn check(common: &CommonArguments, run: &RunArguments) -> Result<Configuration, Failure> {
    let found = Configuration::find(common.config.as_deref(), common.home().path())?;
    SupervisionConfig::new(&found)?;
    checked_processes(common, run)?;
    Ok(found)
}
