//! Debounced log of the table choice: support plane changes that last.

use detection::{Table, TableChoice};
use std::mem::discriminant;

/// Hysteresis: number of consecutive frames after which a new kind of choice is logged.
/// Chosen (1 s at 30 Hz); at the border of two kinds the choice flips with the noise.
const FRAMES_MIN: u32 = 30;

/// Change detector for the table choice, with hysteresis.
#[derive(Debug, Default)]
pub(crate) struct TableLog {
    logged: Option<TableChoice>,
    is_anything_logged: bool,
    n_different: u32,
}

impl TableLog {
    /// Counts a frame's table; logs it after [`FRAMES_MIN`] frames of another kind.
    pub(crate) fn update(&mut self, table: Option<&Table>) {
        let choice = table.map(|table| table.choice);
        let is_same = choice.as_ref().map(discriminant) == self.logged.as_ref().map(discriminant);
        if is_same && self.is_anything_logged {
            self.n_different = 0;
            return;
        }
        self.n_different += 1;
        if self.n_different < FRAMES_MIN {
            return;
        }
        (self.logged, self.is_anything_logged, self.n_different) = (choice, true, 0);
        if let Some(choice) = choice {
            tracing::info!("the table is {choice}");
        } else {
            tracing::info!("no table is seen, and so no objects");
        }
    }
}
