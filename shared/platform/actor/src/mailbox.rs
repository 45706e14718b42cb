//! Bounded mailbox (multi-producer, single-consumer queue) with the overflow policy
//! in its type.
//!
//! A lock-protected queue rather than a lock-free ring: the sender must be able to
//! remove the oldest message, a push costs tens of nanoseconds, and a handler takes a
//! thousand times longer. Messages are dropped outside the lock, since their `Drop`
//! is user code that returns shared memory. `tests/interleavings` model-checks these
//! files over all thread interleavings.

mod endpoints;
mod overflow;
mod queue;
mod send_error;

pub use endpoints::{Receiver, Sender, mailbox};
pub use overflow::{Backpressure, DropOldest, Immediate, Overflow, Refuse};
pub use send_error::SendError;

#[cfg(test)]
mod tests;
