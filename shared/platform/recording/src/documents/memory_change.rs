//! Document of a change of the perceptual memory.

use crate::document::document;
use message::MemoryChange;

document! {
    /// Durable change of the learned views.
    MemoryChangeDocument = "tabula.MemoryChange" {
        /// Identity of the store, 32 hexadecimal digits.
        store_id: String,
        /// Sequence number of the newest history entry.
        sequence: u64,
    }
}

impl From<&MemoryChange> for MemoryChangeDocument {
    fn from(change: &MemoryChange) -> Self {
        let [high, low] = change.store_id;
        Self {
            store_id: format!("{high:016x}{low:016x}"),
            sequence: change.sequence,
        }
    }
}
