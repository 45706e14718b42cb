//! Upper bounds of the shared memory that services reserve.

/// Shared memory that the ports of one service reserve at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reservation {
    /// Name of the iceoryx2 service.
    pub service: &'static str,
    /// Number of message slots of all its senders.
    pub slots: u64,
    /// Size of one message slot, bytes.
    pub slot_bytes: u64,
}

/// Upper bound of iceoryx2's own header before each payload and of the alignment, bytes.
pub(crate) const SLOT_OVERHEAD_BYTES: u64 = 128;

impl Reservation {
    /// Total size of all message slots, bytes.
    pub fn bytes(&self) -> u64 {
        self.slots * self.slot_bytes
    }
}
