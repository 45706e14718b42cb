//! Document of a change of the perceptual memory.

use message::MemoryChange;
use scene_document::Document;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Durable change of the learned views.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MemoryChangeDocument {
    /// Identity of the store, 32 hexadecimal digits.
    pub store_id: String,
    /// Sequence number of the newest history entry.
    pub sequence: u64,
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

impl Document for MemoryChangeDocument {
    const NAME: &'static str = "tabula.MemoryChange";
}
