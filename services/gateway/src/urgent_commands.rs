//! Urgent commands: stop and health, answered past all other requests.

use crate::arm_clients::ArmClients;
use crate::process_table::ProcessTable;
use arm_interface::{StopButton, StopWordError};
use channel::Domain;
use control_protocol::{ArmCommand, Command, Refusal, RefusalKind, Reply};
use daemon_client::CallError;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::Mutex;

/// Time limit for the answer of the arm; a client waits for 5 s.
const DEADLINE: Duration = Duration::from_secs(2);

/// Time for which a stop waits for an arm that is not there. Chosen.
const RESTART_TIME: Duration = Duration::from_millis(500);
/// Pause between two attempts. Chosen.
const RETRY_PERIOD: Duration = Duration::from_millis(5);

/// Answers of the urgent commands.
pub(crate) struct UrgentCommands {
    /// Folder of the domain, with the arm's stop word.
    folder: PathBuf,
    arm: ArmClients,
    processes: Arc<ProcessTable>,
    last_stop: Mutex<Option<Stop>>,
}

/// Stop of the arm with its answer.
struct Stop {
    sent: Instant,
    reply: Reply,
}

impl UrgentCommands {
    /// Answers of the urgent commands in a domain.
    pub(crate) fn new(domain: &Domain, processes: Arc<ProcessTable>) -> Self {
        Self {
            folder: domain.folder().to_owned(),
            arm: ArmClients::new(domain, processes.clone()),
            processes,
            last_stop: Mutex::new(None),
        }
    }

    /// Reply to an urgent command.
    pub(crate) async fn answer(&self, command: Command) -> Reply {
        match command {
            Command::Health => Reply::Health(self.processes.reports()),
            Command::Arm(ArmCommand::Stop) => self.stop().await,
            other => Reply::Refused(Refusal::new(
                RefusalKind::Internal,
                format!("{other:?} is not urgent"),
            )),
        }
    }

    /// Stops the arm by its word in shared memory, and asks for its state. Requests that arrive
    /// while another one waits for that share the next answer, so that a thousand of them wait for
    /// two answers of the arm at most.
    async fn stop(&self) -> Reply {
        let pressed = StopButton::open(&self.folder).and_then(|button| button.press());
        if let Err(error @ StopWordError::File { .. }) = pressed {
            let sentence = format!("the arm was not stopped: {error}");
            return Reply::Refused(Refusal::new(RefusalKind::Unavailable, sentence));
        }
        let arrived = Instant::now();
        let mut last = self.last_stop.lock().await;
        if let Some(stop) = last.as_ref().filter(|stop| stop.sent >= arrived) {
            return stop.reply.clone();
        }
        let sent = Instant::now();
        let reply = self.state().await;
        let reply = reply.unwrap_or_else(|error| Reply::Refused(self.arm.refusal(&error)));
        *last = Some(Stop {
            sent,
            reply: reply.clone(),
        });
        reply
    }

    /// State of the arm after a stop. An arm that begins anew may not have had its word yet: it gets
    /// the stop as a request.
    async fn state(&self) -> Result<Reply, CallError> {
        let begin = Instant::now();
        loop {
            let stop = Command::Arm(ArmCommand::Stop);
            let reply = self.arm.call(None, stop, DEADLINE);
            match reply.await {
                Err(error @ (CallError::NotThere { .. } | CallError::Interrupted { .. }))
                    if begin.elapsed() < RESTART_TIME && !self.arm.is_without_arm(&error) =>
                {
                    tokio::time::sleep(RETRY_PERIOD).await;
                }
                reply => return reply,
            }
        }
    }
}
