//! The primitives whose order of events matters. The files that take them from
//! here are compiled a second time in `tests/interleavings`, where a model
//! checker's take their place.

pub(crate) use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
pub(crate) use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
