//! Refusal of a command for an arm that does not answer.

use crate::process_table::ProcessTable;
use control_protocol::{Refusal, RefusalKind};
use daemon_client::CallError;

/// Sentence about a daemon with a camera in place of the simulator: its arm never comes.
const NO_ARM: &str = "this daemon has no arm, since its source is a camera or a recording, and the \
                      arm is simulated; to have one, stop the daemon and start it with: tabula \
                      run --source simulation";

/// Refusal of a command that the arm did not answer.
pub(crate) fn arm_refusal(error: &CallError, processes: &ProcessTable) -> Refusal {
    let sentence = if is_without_arm(error, processes) {
        NO_ARM.to_owned()
    } else {
        error.to_string()
    };
    Refusal::new(RefusalKind::Unavailable, sentence)
}

/// True if no process of the daemon will ever answer for the arm.
pub(crate) fn is_without_arm(error: &CallError, processes: &ProcessTable) -> bool {
    matches!(error, CallError::NotThere { .. }) && processes.has_camera()
}
