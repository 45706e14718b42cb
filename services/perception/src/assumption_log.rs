//! Log of changes in the assumptions that detection makes.

use constraint::{Assumption, Assumptions};

/// Change detector for the assumptions; logs each that begins or ends.
#[derive(Debug, Default)]
pub(crate) struct AssumptionLog {
    logged: Assumptions,
}

impl AssumptionLog {
    /// Logs the differences between a frame's assumptions and those logged last.
    pub(crate) fn update(&mut self, assumptions: Assumptions) {
        if assumptions == self.logged {
            return;
        }
        for assumption in Assumption::ALL {
            match (
                self.logged.contains(assumption),
                assumptions.contains(assumption),
            ) {
                (false, true) => tracing::info!("assumed from here on: {}", assumption.sentence()),
                (true, false) => tracing::info!("assumed no more: {}", assumption.sentence()),
                _ => {}
            }
        }
        self.logged = assumptions;
    }
}
