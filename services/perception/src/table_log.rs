//! Tells which table is looked at, when that changes for good.

use detection::{Table, TableChoice};
use std::mem::discriminant;

/// A new kind of choice is told after so many frames in a row: at the border of
/// two kinds the choice turns with the noise.
const FRAMES_MIN: u32 = 30;

/// What was told last, and for how long something else has been so.
#[derive(Debug, Default)]
pub(crate) struct TableLog {
    told: Option<TableChoice>,
    is_anything_told: bool,
    n_other: u32,
}

impl TableLog {
    /// Takes a frame's table, and tells why it is the table once that has lasted.
    pub(crate) fn tell(&mut self, table: Option<&Table>) {
        let choice = table.map(|table| table.choice);
        let is_told = choice.as_ref().map(discriminant) == self.told.as_ref().map(discriminant);
        if is_told && self.is_anything_told {
            self.n_other = 0;
            return;
        }
        self.n_other += 1;
        if self.n_other < FRAMES_MIN {
            return;
        }
        (self.told, self.is_anything_told, self.n_other) = (choice, true, 0);
        if let Some(choice) = choice {
            tracing::info!("the table is {choice}");
        } else {
            tracing::info!("no table is seen, and so no objects");
        }
    }
}
