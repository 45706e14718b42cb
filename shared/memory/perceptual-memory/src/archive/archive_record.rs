//! Archive record: the extent of the archived part of the history, after which the entries in the
//! database go on.

use serde::{Deserialize, Serialize};

use crate::digest::Digest;

/// Extent of the archive. It is advanced in the batch that removes the archived entries from
/// the database.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ArchiveRecord {
    /// Sequence number of the last archived entry; zero for none.
    pub(crate) sequence: u64,
    /// Digest of the last archived entry.
    pub(crate) head: Digest,
    /// Sequence number of the last entry that was dropped for the limit of the archive.
    pub(crate) dropped: u64,
    /// Size of the segments, bytes.
    pub(crate) n_bytes: u64,
    /// Ranges of archived entries that were lost with a damaged store.
    pub(crate) lost: Vec<(u64, u64)>,
}
