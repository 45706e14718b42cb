//! Limits of the history: entries in the database, size and age of the archive.

/// Limits of the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryLimits {
    /// Number of newest entries that stay in the database, at least.
    pub kept_entries: u64,
    /// Number of entries in an archive segment, at least one.
    pub segment_entries: u64,
    /// Maximum size of the archive, bytes; above it the oldest segments are dropped.
    pub archive_max_bytes: u64,
    /// Time for which the idempotency keys of archived entries are kept, nanoseconds.
    pub answered_kept_ns: u64,
}

impl HistoryLimits {
    /// Default number of entries in an archive segment: about a megabyte.
    pub const SEGMENT_ENTRIES: u64 = 4096;
    /// Limits that the daemon is configured with by default.
    pub const CONFIGURED: Self = Self {
        kept_entries: 16_384,
        segment_entries: Self::SEGMENT_ENTRIES,
        archive_max_bytes: 32 << 30,
        answered_kept_ns: 30 * 24 * 3600 * 1_000_000_000,
    };
}

impl Default for HistoryLimits {
    /// No limits: all entries stay in the database.
    fn default() -> Self {
        Self {
            kept_entries: u64::MAX,
            segment_entries: Self::SEGMENT_ENTRIES,
            archive_max_bytes: u64::MAX,
            answered_kept_ns: u64::MAX,
        }
    }
}
