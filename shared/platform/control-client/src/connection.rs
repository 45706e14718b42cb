//! Connection to a daemon's control socket, with replies turned into results.

use channel::RunFolder;
use channel::control::{CallError, SocketClient};
use message::control::{Command, Refusal, RefusalKind, Reply};
use service::{CommonArguments, Failure, exit_code};
use std::time::Duration;

/// Timeout of one answer of the daemon. Chosen.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);

/// Connects to the daemon's control socket.
///
/// # Errors
/// If no daemon runs or it refuses the connection.
pub fn connect(common: &CommonArguments) -> Result<SocketClient, Failure> {
    try_connect(common).map_err(|error| call_failure(&error))
}

/// As [`connect`], with the error of the channel.
pub(crate) fn try_connect(common: &CommonArguments) -> Result<SocketClient, CallError> {
    SocketClient::connect(&common.domain, &RunFolder::candidates(), ANSWER_TIMEOUT)
}

/// Sends a command on a connection of its own and returns the reply; an urgent one is repeated
/// when its connection was closed in favour of newer ones.
///
/// # Errors
/// As [`connect`] and [`call`].
pub fn call_once(common: &CommonArguments, command: &Command) -> Result<Reply, Failure> {
    let folders = RunFolder::candidates();
    let reply = SocketClient::call_once(&common.domain, &folders, ANSWER_TIMEOUT, command);
    reply_or_failure(reply)
}

/// Sends a command and returns the reply; a refusal becomes a failure.
///
/// # Errors
/// If the command is refused, or the daemon does not answer in time.
pub fn call(client: &mut SocketClient, command: Command) -> Result<Reply, Failure> {
    reply_or_failure(client.call(command))
}

/// Reply of a call; a refusal becomes a failure.
pub(crate) fn reply_or_failure(reply: Result<Reply, CallError>) -> Result<Reply, Failure> {
    match reply.map_err(|error| call_failure(&error))? {
        Reply::Refused(refusal) => Err(refusal_failure(refusal)),
        reply => Ok(reply),
    }
}

/// Failure of a refusal, with its exit code.
pub fn refusal_failure(refusal: Refusal) -> Failure {
    let code = match refusal.kind {
        RefusalKind::Unavailable => exit_code::NO_DAEMON,
        RefusalKind::UnknownOutcome => exit_code::TIMED_OUT,
        RefusalKind::Internal | RefusalKind::Version => exit_code::FAILURE,
        _ => exit_code::REFUSED,
    };
    let is_missing = refusal.kind == RefusalKind::NotFound;
    let failure = Failure::new(code, refusal);
    if is_missing {
        failure.of_missing()
    } else {
        failure
    }
}

pub(crate) fn call_failure(error: &CallError) -> Failure {
    let code = match error {
        CallError::NoDaemon { .. } | CallError::NotThere { .. } => exit_code::NO_DAEMON,
        CallError::TimedOut { .. } => exit_code::TIMED_OUT,
        _ => exit_code::FAILURE,
    };
    Failure::new(code, error)
}

/// Failure of a reply that does not fit its command.
pub fn unexpected_reply(reply: &Reply) -> Failure {
    Failure::general(format!("the daemon answered something else: {reply:?}"))
}
