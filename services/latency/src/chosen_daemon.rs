//! Which daemon is measured.

use crate::arguments::SourceArguments;
use crate::own_daemon::OwnDaemon;
use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use command_line::Output;
use message::ProcessKind;
use service::{CommonArguments, Failure};

/// What is measured when nothing is named and nothing runs.
const USUAL_SOURCE: &str = "simulation:isolated";
const USUAL_OBJECTS: u32 = 10;

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
            let arguments = run_arguments(source, common);
            output.tell(&format!(
                "starting a daemon: tabula run {}",
                arguments.join(" ")
            ));
            Some(OwnDaemon::start(&arguments)?)
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

fn run_arguments(source: &SourceArguments, common: &CommonArguments) -> Vec<String> {
    let name = source.source.as_deref().unwrap_or(USUAL_SOURCE);
    let is_simulated = name.starts_with("simulation");
    let objects = match (source.objects, is_simulated && source.source.is_none()) {
        (None, true) => Some(USUAL_OBJECTS),
        (given, _) => given,
    };
    let mut arguments = vec![format!("--source={name}")];
    // A recording is played again and again: a measurement has a length of its own.
    let plays_files = std::path::Path::new(name).is_dir();
    arguments.extend(plays_files.then(|| "--loop".to_owned()));
    arguments.extend(objects.map(|n| format!("--objects={n}")));
    arguments.extend(source.seed.map(|seed| format!("--seed={seed}")));
    arguments.extend(source.rate.map(|rate| format!("--rate={rate}")));
    arguments.extend(
        common
            .config
            .as_ref()
            .map(|config| format!("--config={}", config.display())),
    );
    arguments
}
