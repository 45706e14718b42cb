//! The primitives whose order of events matters. The files that take them from
//! here are compiled a second time in `tests/interleavings`, where a model
//! checker's take their place.

pub(crate) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
pub(crate) use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// How often somebody looks whether what he waits for is there before he sleeps; about
/// as long as it takes to be waked.
pub(crate) const PATIENCE: usize = 2_000;

/// Between two looks.
pub(crate) fn pause() {
    std::hint::spin_loop();
}
