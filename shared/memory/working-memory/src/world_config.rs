//! Configuration of the world model: change thresholds and retention.

/// Configuration of a [`WorldModel`](crate::WorldModel): retention and change thresholds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldConfig {
    /// Minimum change of an object's centre or side length for a new fact, metres.
    pub move_min_m: f64,
    /// Minimum rotation of an object for a new fact, radians.
    pub turn_min_rad: f64,
    /// Retention time of ended facts, tasks and objects, nanoseconds.
    pub keep_ns: u64,
    /// Maximum number of ended facts, of past objects, of ended tasks, and of events.
    pub n_kept_most: usize,
    /// Maximum age of the last-seen time of an object on disk, nanoseconds.
    pub seen_period_ns: u64,
    /// Size of the write buffer (memtable), bytes; usually
    /// [`WRITE_BUFFER_BYTES`](crate::WRITE_BUFFER_BYTES).
    pub write_buffer_bytes: usize,
}
