//! Which daemon is measured.

use crate::arguments::SourceArguments;
use crate::own_daemon::OwnDaemon;
use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use command_line::Output;
use message::ProcessKind;
use service::{CommonArguments, Failure};

/// The daemon that is measured: one that ran before, or one of our own.
#[derive(Debug)]
pub(crate) struct ChosenDaemon {
    /// Membership, given up before an own daemon is stopped.
    pub(crate) domain: Domain,
    /// Stopped at the end.
    own: Option<OwnDaemon>,
}

impl ChosenDaemon {
    /// Joins the domain's daemon; with a source, or when there is none, starts one.
    ///
    /// # Errors
    /// When the daemon can not be started, or the domain not joined.
    pub(crate) fn choose(
        common: &CommonArguments,
        source: &SourceArguments,
        output: &Output,
    ) -> Result<Self, Failure> {
        let run_folder = RunFolder::of_user();
        let own = if source.is_given() || !is_running(&common.domain, &run_folder) {
            let arguments = source.run_arguments(common.config.as_deref());
            output.tell(&format!(
                "starting a daemon: tabula run {}",
                arguments.join(" ")
            ));
            Some(OwnDaemon::start(OwnDaemon::home()?, &arguments, None)?)
        } else {
            output.tell(&format!(
                "measuring the daemon of the domain {}",
                common.domain
            ));
            None
        };
        let name = own.as_ref().map_or(&common.domain, OwnDaemon::domain);
        let domain = Domain::join(name, &run_folder, Role::Guest)?;
        Ok(Self { domain, own })
    }

    /// Joins a daemon of our own.
    ///
    /// # Errors
    /// When its domain can not be joined.
    pub(crate) fn join_own(own: OwnDaemon) -> Result<Self, Failure> {
        let domain = Domain::join(own.domain(), &RunFolder::of_user(), Role::Guest)?;
        Ok(Self {
            domain,
            own: Some(own),
        })
    }

    /// Whether the daemon runs for this measurement only.
    pub(crate) fn is_own(&self) -> bool {
        self.own.is_some()
    }
}

/// Whether somebody works on frames in the domain.
fn is_running(domain: &DomainName, run_folder: &RunFolder) -> bool {
    let perception = ProcessKind::Perception.program();
    let state = DomainState::of(domain, run_folder);
    state.running.iter().any(|(role, _)| *role == perception)
}
