//! Tells when something begins or ceases to be taken for granted.

use constraint::{Assumption, Assumptions};

/// What was told last.
#[derive(Debug, Default)]
pub(crate) struct AssumptionLog {
    told: Assumptions,
}

impl AssumptionLog {
    /// Tells what has changed.
    pub(crate) fn tell(&mut self, assumptions: Assumptions) {
        if assumptions == self.told {
            return;
        }
        for assumption in Assumption::ALL {
            match (
                self.told.contains(assumption),
                assumptions.contains(assumption),
            ) {
                (false, true) => tracing::info!("assumed from here on: {}", assumption.sentence()),
                (true, false) => tracing::info!("assumed no more: {}", assumption.sentence()),
                _ => {}
            }
        }
        self.told = assumptions;
    }
}
