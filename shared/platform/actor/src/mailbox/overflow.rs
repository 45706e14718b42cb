//! What a full mailbox does, as a type.

mod sealed {
    pub trait Sealed {}
}

/// What a full mailbox does with the next message.
pub trait Overflow: sealed::Sealed + Send + Sync + 'static {
    /// Whether the receiver must tell waiting senders of the room it made.
    #[doc(hidden)]
    const SENDERS_WAIT: bool;
}

/// A policy under which a sender never waits.
pub trait Immediate: Overflow {
    /// Whether the oldest message makes room for the newest.
    #[doc(hidden)]
    const DISPLACES: bool;
}

/// Drops the oldest message and counts it: for sensor data.
#[derive(Debug, Clone, Copy)]
pub struct KeepLatest;

/// Lets the sender wait for room: for streams that must be complete.
#[derive(Debug, Clone, Copy)]
pub struct Block;

/// Hands the message back to the sender: for commands.
#[derive(Debug, Clone, Copy)]
pub struct Refuse;

impl sealed::Sealed for KeepLatest {}
impl sealed::Sealed for Block {}
impl sealed::Sealed for Refuse {}

impl Overflow for KeepLatest {
    const SENDERS_WAIT: bool = false;
}
impl Overflow for Block {
    const SENDERS_WAIT: bool = true;
}
impl Overflow for Refuse {
    const SENDERS_WAIT: bool = false;
}

impl Immediate for KeepLatest {
    const DISPLACES: bool = true;
}
impl Immediate for Refuse {
    const DISPLACES: bool = false;
}
