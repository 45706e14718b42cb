//! Connection to a daemon's control socket, with replies turned into results.

use channel::RunFolder;
use control_protocol::{Refusal, RefusalKind, TypedRequest};
use daemon_client::{CallError, DaemonClient};
use service::{CommonArguments, Failure, exit_code};
use std::time::Duration;

/// Timeout of one answer of the daemon. Chosen.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);

/// Connects to the daemon's control socket.
///
/// # Errors
/// If no daemon runs or it refuses the connection.
pub fn connect(common: &CommonArguments) -> Result<DaemonClient, Failure> {
    try_connect(common).map_err(call_failure)
}

/// As [`connect`], with the error of the channel.
pub(crate) fn try_connect(common: &CommonArguments) -> Result<DaemonClient, CallError> {
    DaemonClient::connect(&common.domain, &RunFolder::candidates(), ANSWER_TIMEOUT)
}

/// Sends a request on a connection of its own and returns the value of its reply; an urgent one is
/// repeated when its connection was closed in favour of newer ones.
///
/// # Errors
/// As [`connect`] and [`ask`].
pub fn ask_once<T>(common: &CommonArguments, request: &TypedRequest<T>) -> Result<T, Failure> {
    let folders = RunFolder::candidates();
    DaemonClient::ask_once(&common.domain, &folders, ANSWER_TIMEOUT, request).map_err(call_failure)
}

/// Sends a request and returns the value of its reply; a refusal becomes a failure.
///
/// # Errors
/// If the request is refused, or the daemon does not answer in time.
pub fn ask<T>(client: &mut DaemonClient, request: &TypedRequest<T>) -> Result<T, Failure> {
    client.ask(request).map_err(call_failure)
}

/// Failure of a refusal, with its exit code.
fn refusal_failure(refusal: Refusal) -> Failure {
    let code = match refusal.kind {
        RefusalKind::Unavailable => exit_code::NO_DAEMON,
        RefusalKind::UnknownOutcome | RefusalKind::TimedOut => exit_code::TIMED_OUT,
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

/// Failure of a call, with its exit code.
pub(crate) fn call_failure(error: CallError) -> Failure {
    let code = match error {
        CallError::Refusal(refusal) => return refusal_failure(refusal),
        CallError::NoDaemon { .. } | CallError::NotThere { .. } | CallError::Interrupted { .. } => {
            exit_code::NO_DAEMON
        }
        CallError::TimedOut { .. } => exit_code::TIMED_OUT,
        _ => exit_code::FAILURE,
    };
    Failure::new(code, error)
}
