//! Selection of the daemon under test: a running one or a spawned one.

use crate::arguments::SourceArguments;
use crate::measured_daemon::MeasuredDaemon;
use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use command_line::Output;
use message::ProcessKind;
use service::{CommonArguments, Failure};

/// Daemon under test: one that was running, or one spawned for the measurement.
#[derive(Debug)]
pub(crate) struct DaemonUnderTest {
    /// Domain membership; left before a spawned daemon is stopped.
    pub(crate) domain: Domain,
    /// Daemon spawned for the measurement, stopped on drop.
    own: Option<MeasuredDaemon>,
}

impl DaemonUnderTest {
    /// Joins the running daemon of the domain; spawns one if a source is given or none runs.
    ///
    /// # Errors
    /// If the daemon cannot be started or its domain cannot be joined, or a configuration is given
    /// for one that runs.
    pub(crate) fn choose(
        common: &CommonArguments,
        source: &SourceArguments,
        output: &Output,
    ) -> Result<Self, Failure> {
        let run_folder = RunFolder::of_user();
        let own = if source.is_given() || !is_running(&common.domain, &run_folder) {
            let arguments = source.run_arguments(common.config.as_deref());
            output.print_status(&format!(
                "starting a daemon: tabula run {}",
                arguments.join(" ")
            ));
            Some(MeasuredDaemon::start(
                MeasuredDaemon::home()?,
                &arguments,
                None,
            )?)
        } else if common.config.is_some() {
            return Err(Failure::usage(format!(
                "--config has no meaning for the running daemon of the domain {}, which has its own \
                 configuration; leave it out, or name a --source for a daemon with this one",
                common.domain
            )));
        } else {
            output.print_status(&format!(
                "measuring the daemon of the domain {}",
                common.domain
            ));
            None
        };
        let name = own.as_ref().map_or(&common.domain, MeasuredDaemon::domain);
        let domain = Domain::join(name, &run_folder, Role::Guest)?;
        Ok(Self { domain, own })
    }

    /// Joins the domain of a spawned daemon.
    ///
    /// # Errors
    /// If its domain cannot be joined.
    pub(crate) fn join_spawned(own: MeasuredDaemon) -> Result<Self, Failure> {
        let domain = Domain::join(own.domain(), &RunFolder::of_user(), Role::Guest)?;
        Ok(Self {
            domain,
            own: Some(own),
        })
    }

    /// `true` if the daemon was spawned for this measurement.
    pub(crate) fn is_own(&self) -> bool {
        self.own.is_some()
    }
}

/// `true` if a perception process runs in the domain.
fn is_running(domain: &DomainName, run_folder: &RunFolder) -> bool {
    let perception = ProcessKind::PERCEPTION.program();
    let state = DomainState::inspect(domain, run_folder);
    state.running.iter().any(|(role, _)| *role == perception)
}
