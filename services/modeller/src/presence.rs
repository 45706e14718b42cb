//! Presence of the daemon beside which this program works.

use channel::{DomainName, DomainState, RunFolder};
use service::{Failure, exit_code};

/// True if processes of a daemon run in the domain.
pub(crate) fn is_running(name: &DomainName) -> bool {
    !DomainState::inspect(name, &RunFolder::of_user())
        .running
        .is_empty()
}

/// Fails without a daemon in the domain.
///
/// # Errors
/// When no process of a daemon runs.
pub(crate) fn require_daemon(name: &DomainName) -> Result<(), Failure> {
    if is_running(name) {
        return Ok(());
    }
    let sentence = format!("no daemon runs in the domain {name}; start one with `tabula run`");
    Err(Failure::new(exit_code::NO_DAEMON, sentence))
}
