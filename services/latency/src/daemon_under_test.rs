//! Selection of the daemon under test: a running one or a spawned one.

use crate::arguments::SourceArguments;
use crate::measured_daemon::MeasuredDaemon;
use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use command_line::Output;
use message::ProcessKind;
use service::{CommonArguments, Failure};
use tempfile::TempDir;

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
        if source.is_given() || !is_running(&common.domain, &run_folder) {
            let arguments = source.run_arguments(common.config.as_deref());
            output.print_status(&format!(
                "starting a daemon: tabula run {}",
                arguments.join(" ")
            ));
            return Self::start(MeasuredDaemon::home()?, &arguments, None);
        }
        if common.config.is_some() {
            return Err(Failure::usage(format!(
                "--config has no meaning for the running daemon of the domain {}, which has its own \
                 configuration; leave it out, or name a --source for a daemon with this one",
                common.domain
            )));
        }
        output.print_status(&format!(
            "measuring the daemon of the domain {}",
            common.domain
        ));
        let domain = Domain::join(&common.domain, &run_folder, Role::Guest)?;
        Ok(Self { domain, own: None })
    }

    /// Starts a daemon in a folder, on the first cores if their number is given, and joins its
    /// domain.
    ///
    /// # Errors
    /// If the daemon cannot be started or its domain cannot be joined.
    pub(crate) fn start(
        home: TempDir,
        run_arguments: &[String],
        n_cores: Option<usize>,
    ) -> Result<Self, Failure> {
        let own = MeasuredDaemon::start(home, run_arguments, n_cores)?;
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
