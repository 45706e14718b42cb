//! Clock of a task: monotonic time, or that of the source in lockstep.

use std::time::{Duration, Instant};

/// Clock of a task. In lockstep, time is that of the frames, so that a repetition decides the same.
#[derive(Debug, Clone, Copy)]
pub(crate) enum RobotClock {
    /// Time since the start of the process.
    Monotonic(Instant),
    /// Capture time of the newest frame, on the source's clock.
    Lockstep(Duration),
}

impl RobotClock {
    /// Time, since an instant that is the same for all readings of one clock.
    pub(crate) fn now(&self) -> Duration {
        match self {
            Self::Monotonic(start) => start.elapsed(),
            Self::Lockstep(captured) => *captured,
        }
    }

    /// True if a source in lockstep sets the time.
    pub(crate) fn is_lockstep(&self) -> bool {
        matches!(self, Self::Lockstep(_))
    }
}
