//! Losses of a recording as fields of a JSON document.

use recording::ReadSummary;
use serde::Serialize;

/// Parts of a recording that could not be read.
#[derive(Debug, Serialize)]
pub(crate) struct LossDocument {
    pub(crate) damaged_chunks: u64,
    pub(crate) unsupported_chunks: u64,
    pub(crate) damaged_records: u64,
    pub(crate) messages_without_channel: u64,
    pub(crate) lost_bytes: u64,
}

impl From<ReadSummary> for LossDocument {
    fn from(read: ReadSummary) -> Self {
        Self {
            damaged_chunks: read.n_damaged_chunks,
            unsupported_chunks: read.n_unsupported_chunks,
            damaged_records: read.n_damaged_records,
            messages_without_channel: read.n_without_channel,
            lost_bytes: read.lost_bytes,
        }
    }
}
