//! What is worth a new fact, and how long it is remembered.

/// The settings of a [`WorldModel`](super::WorldModel).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldConfig {
    /// An object is in another place when its centre, or the length of a side, is
    /// this far from what the last fact says, metres.
    pub move_min_m: f64,
    /// Or when it is turned this far, radians.
    pub turn_min_rad: f64,
    /// What is over is forgotten after this time, nanoseconds.
    pub keep_ns: u64,
    /// And before that when more than this many facts are over; the same holds for
    /// objects, for tasks, and for all events.
    pub n_kept_most: usize,
    /// When an object was last seen is written at least this often, nanoseconds.
    pub seen_period_ns: u64,
    /// What is gathered in memory before the database makes a table of it, usually
    /// [`WRITE_BUFFER_BYTES`](crate::WRITE_BUFFER_BYTES).
    pub write_buffer_bytes: usize,
}
