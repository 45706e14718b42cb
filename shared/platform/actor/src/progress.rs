//! Heartbeat of a long handler, read by the watchdog.

use crate::sync::{AtomicU64, Ordering};

/// Progress counter by which the watchdog distinguishes slow work from stuck work.
///
/// A handler that may run longer than the pool's stall time calls
/// [`tick`](Self::tick) in its outer loop.
#[derive(Debug, Default)]
pub struct Progress(AtomicU64);

impl Progress {
    /// Records progress. One relaxed increment: cheap enough for every row of an
    /// image.
    #[inline]
    pub fn tick(&self) {
        // Relaxed: only the fact of change is read, nothing is published by it.
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// Number of progress ticks, modulo 2^64.
    pub fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}
