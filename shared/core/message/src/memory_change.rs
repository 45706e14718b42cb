//! Change notification of the perceptual memory.

use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Notification of a durable change of the learned views. It is only a hint: readers request
/// the changes since the sequence they hold, so a lost notification does no harm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.MemoryChange.v1")]
#[repr(C)]
pub struct MemoryChange {
    /// Identity of the store, 128 bits: high half, low half.
    pub store_id: [u64; 2],
    /// Sequence number of the newest history entry.
    pub sequence: u64,
}

const _: () = assert!(size_of::<MemoryChange>() == 24);
