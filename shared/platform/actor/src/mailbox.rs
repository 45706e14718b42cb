//! The bounded mailbox: many senders, one receiver, the overflow policy in the type.
//!
//! A lock-protected queue rather than a lock-free ring: the sender must be able
//! to remove the oldest message, a push costs tens of nanoseconds, and a handler
//! takes a thousand times longer. Messages are dropped outside the lock, since
//! their `Drop` returns shared memory and is not ours. `tests/interleavings`
//! runs these files through every order of events that a few threads can bring
//! about.

mod ends;
mod overflow;
mod queue;
mod send_error;

pub use ends::{Receiver, Sender, mailbox};
pub use overflow::{Block, Immediate, KeepLatest, Overflow, Refuse};
pub use send_error::SendError;

#[cfg(test)]
mod tests;
