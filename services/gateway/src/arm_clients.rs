//! Clients of whoever moves the arm: the driver of a real one, or the simulator.

use crate::process_table::ProcessTable;
use channel::Domain;
use channel::control::Client;
use control_protocol::{Command, Peer, Refusal, RefusalKind, Reply};
use daemon_client::CallError;
use message::ProcessKind;
use std::sync::Arc;
use std::time::Duration;

/// Sentence about a daemon with a camera in place of the simulator, and without a driver: its arm
/// never comes.
const NO_ARM: &str = "this daemon has no arm, since its source is a camera or a recording, and no \
                      driver of an arm runs in it; to have a simulated arm, stop the daemon and \
                      start it with: tabula run --source simulation";

/// Clients of the arm's two possible owners; the driver goes before the simulator.
#[derive(Clone)]
pub(crate) struct ArmClients {
    driver: Client,
    simulator: Client,
    processes: Arc<ProcessTable>,
}

impl ArmClients {
    pub(crate) fn new(domain: &Domain, processes: Arc<ProcessTable>) -> Self {
        Self {
            driver: Client::new(domain, ProcessKind::ARM),
            simulator: Client::new(domain, ProcessKind::SIMULATOR),
            processes,
        }
    }

    /// Sends a command to the arm and waits for the reply; on behalf of a user, if there is one.
    ///
    /// # Errors
    /// As [`Client::call`].
    pub(crate) async fn call(
        &self,
        user: Option<Peer>,
        command: Command,
        deadline: Duration,
    ) -> Result<Reply, CallError> {
        let driven = call(&self.driver, user, command.clone(), deadline).await;
        // A driver that is started anew gets the next request, and no other arm gets this one.
        let is_driverless =
            matches!(driven, Err(CallError::NotThere { .. })) && !self.processes.expects_driver();
        if is_driverless {
            call(&self.simulator, user, command, deadline).await
        } else {
            driven
        }
    }

    /// Refusal of a command that the arm did not answer.
    pub(crate) fn refusal(&self, error: &CallError) -> Refusal {
        let sentence = if self.is_without_arm(error) {
            NO_ARM.to_owned()
        } else {
            error.to_string()
        };
        Refusal::new(RefusalKind::Unavailable, sentence)
    }

    /// True if no process of the daemon will ever answer for the arm.
    pub(crate) fn is_without_arm(&self, error: &CallError) -> bool {
        let is_absent = matches!(error, CallError::NotThere { .. });
        is_absent && self.processes.has_camera() && !self.processes.expects_driver()
    }
}

async fn call(
    client: &Client,
    user: Option<Peer>,
    command: Command,
    deadline: Duration,
) -> Result<Reply, CallError> {
    match user {
        Some(user) => client.call_for(user, command, deadline).await,
        None => client.call(command, deadline).await,
    }
}
