//! Request router: passes each command to the process that owns it.

use crate::arm_clients::ArmClients;
use crate::history_position::HistoryPosition;
use crate::process_table::ProcessTable;
use channel::Domain;
use channel::control::Client;
use control_protocol::{Command, Peer, Refusal, RefusalKind, Reply, UserRole};
use daemon_client::CallError;
use message::{Duty, ProcessKind};
use std::sync::Arc;
use std::time::Duration;

/// Time limit for the answer of an owner, beside the time that a request itself waits for an event;
/// a client waits for 5 s.
const DEADLINE: Duration = Duration::from_secs(4);

/// Router of all requests that are not urgent.
pub(crate) struct RequestRouter {
    domain: Domain,
    owners: Vec<(ProcessKind, Client)>,
    arm: ArmClients,
    processes: Arc<ProcessTable>,
    position: HistoryPosition,
}

impl RequestRouter {
    pub(crate) fn new(
        domain: &Domain,
        processes: Arc<ProcessTable>,
        position: HistoryPosition,
    ) -> Self {
        let owners = ProcessKind::all().filter(|process| process.has(Duty::Owner));
        Self {
            domain: domain.clone(),
            owners: owners
                .map(|process| (process, Client::new(domain, process)))
                .collect(),
            arm: ArmClients::new(domain, processes.clone()),
            processes,
            position,
        }
    }

    /// Reply to a command of a user; a refusal gives the reason.
    pub(crate) async fn answer(&self, command: Command, user: Peer) -> Reply {
        match command {
            Command::Health => Reply::Health(self.processes.reports()),
            Command::ReloadConfiguration => {
                Reply::Reloaded(service::reload_processes(&self.domain, DEADLINE).await)
            }
            command => {
                let passed_on = self.pass_on(command, user).await;
                passed_on.unwrap_or_else(Reply::Refused)
            }
        }
    }

    async fn pass_on(&self, command: Command, user: Peer) -> Result<Reply, Refusal> {
        let process = command.owner();
        let deadline = DEADLINE + command.waiting_time();
        if process == ProcessKind::ARM {
            let reply = self.arm.call(Some(user), command, deadline).await;
            return reply.map_err(|error| self.arm.refusal(&error));
        }
        let owner = self.owners.iter().find(|(owner, _)| *owner == process);
        let Some((_, owner)) = owner else {
            let sentence = format!("{} answers no requests", process.program());
            return Err(Refusal::new(RefusalKind::Internal, sentence));
        };
        let is_change = command.required_role() > UserRole::Reader;
        let command = if process == ProcessKind::PERCEPTION {
            self.position.stamp(command)
        } else {
            command
        };
        let reply = owner.call_for(user, command, deadline).await;
        reply.map_err(|error| {
            if process.has(Duty::Commander) && self.arm.is_without_arm(&error) {
                self.arm.refusal(&error)
            } else {
                refusal(&error, process, is_change)
            }
        })
    }
}

/// Refusal of a command whose owner did not answer. Of a change that was sent the outcome is
/// unknown.
fn refusal(error: &CallError, owner: ProcessKind, is_change: bool) -> Refusal {
    let was_sent = !matches!(error, CallError::NotThere { .. } | CallError::Refused(_));
    let (kind, sentence) = match error {
        CallError::TimedOut { after } => {
            let seconds = after.as_secs_f64();
            let sentence = format!(
                "no answer within {seconds} s from {}, which is busy or stuck; see `tabula \
                 status` and its log",
                owner.program(),
            );
            (RefusalKind::TimedOut, sentence)
        }
        error => (RefusalKind::Unavailable, error.to_string()),
    };
    let kind = if is_change && was_sent {
        RefusalKind::UnknownOutcome
    } else {
        kind
    };
    Refusal::new(kind, sentence)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcome_of_a_change_is_unknown_once_it_was_sent() {
        let after = Duration::from_secs(4);
        let kind =
            |error: CallError, is_change| refusal(&error, ProcessKind::MEMORY, is_change).kind;
        let timed_out = || CallError::TimedOut { after };
        assert_eq!(kind(timed_out(), true), RefusalKind::UnknownOutcome);
        assert_eq!(kind(timed_out(), false), RefusalKind::TimedOut);
        let not_there = CallError::NotThere { process: "memory" };
        assert_eq!(kind(not_there, true), RefusalKind::Unavailable);
        let ended = CallError::Interrupted { process: "memory" };
        assert_eq!(kind(ended, true), RefusalKind::UnknownOutcome);
    }
}
