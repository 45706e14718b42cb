//! Synchronisation primitives behind one import, so that loom can replace them. The
//! files that use them are compiled a second time in `tests/interleavings` with the
//! primitives of that model checker.

pub(crate) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
pub(crate) use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Iterations of spinning before a thread sleeps; about as long as a wake-up takes.
pub(crate) const SPIN_LIMIT: usize = 2_000;

/// One iteration of a spin loop.
pub(crate) fn pause() {
    std::hint::spin_loop();
}
