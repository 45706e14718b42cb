//! Connection to a daemon's control socket, with replies turned into results.

use channel::RunFolder;
use channel::control::{CallError, SocketClient};
use message::control::{Command, Refusal, RefusalKind, Reply};
use service::{CommonArguments, Failure, exit_code};
use std::time::Duration;

/// How long the daemon may take to answer.
const DEADLINE: Duration = Duration::from_secs(5);
/// Connects to the daemon's control socket.
pub fn connect(common: &CommonArguments) -> Result<SocketClient, Failure> {
    let connected = SocketClient::connect(&common.domain, &RunFolder::candidates(), DEADLINE);
    connected.map_err(|error| call_failed(&error))
}

/// Asks, and turns a refusal into a failure.
pub fn call(client: &mut SocketClient, command: Command) -> Result<Reply, Failure> {
    match client.call(command).map_err(|error| call_failed(&error))? {
        Reply::Refused(refusal) => Err(refused(refusal)),
        reply => Ok(reply),
    }
}

/// A refusal with its exit code.
pub fn refused(refusal: Refusal) -> Failure {
    let code = match refusal.kind {
        RefusalKind::Unavailable => exit_code::NO_DAEMON,
        RefusalKind::Internal | RefusalKind::Version => exit_code::FAILURE,
        _ => exit_code::REFUSED,
    };
    Failure::new(code, refusal)
}

fn call_failed(error: &CallError) -> Failure {
    let code = match error {
        CallError::NoDaemon { .. } | CallError::NotThere { .. } => exit_code::NO_DAEMON,
        CallError::TimedOut { .. } => exit_code::TIMED_OUT,
        _ => exit_code::FAILURE,
    };
    Failure::new(code, error)
}

/// A reply that does not fit its command.
pub fn unexpected(reply: &Reply) -> Failure {
    Failure::new(
        exit_code::FAILURE,
        format!("the daemon answered something else: {reply:?}"),
    )
}
