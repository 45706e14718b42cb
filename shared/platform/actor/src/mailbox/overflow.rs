//! Overflow policies of a mailbox as types: drop oldest, block, refuse.

mod sealed {
    pub trait Sealed {}
}

/// Overflow policy: the treatment of a message sent to a full mailbox.
pub trait Overflow: sealed::Sealed + Send + Sync + 'static {
    /// `true` when the receiver must wake waiting senders after making room.
    #[doc(hidden)]
    const SENDERS_WAIT: bool;
}

/// Overflow policy under which a sender never waits.
pub trait Immediate: Overflow {
    /// `true` when the newest message displaces the oldest.
    #[doc(hidden)]
    const DISPLACES: bool;
}

/// Drop-oldest policy: displaces the oldest message and counts it; for sensor data.
#[derive(Debug, Clone, Copy)]
pub struct DropOldest;

/// Back-pressure policy: the sender waits for room; for streams that must be
/// complete.
#[derive(Debug, Clone, Copy)]
pub struct Backpressure;

/// Refusal policy: the message returns to the sender; for commands.
#[derive(Debug, Clone, Copy)]
pub struct Refuse;

impl sealed::Sealed for DropOldest {}
impl sealed::Sealed for Backpressure {}
impl sealed::Sealed for Refuse {}

impl Overflow for DropOldest {
    const SENDERS_WAIT: bool = false;
}
impl Overflow for Backpressure {
    const SENDERS_WAIT: bool = true;
}
impl Overflow for Refuse {
    const SENDERS_WAIT: bool = false;
}

impl Immediate for DropOldest {
    const DISPLACES: bool = true;
}
impl Immediate for Refuse {
    const DISPLACES: bool = false;
}
