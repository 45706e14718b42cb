//! The memory's announcement that its history has grown.

use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Sent after each durable change of what was learned. It is a hint: readers ask
/// for the changes since the sequence they hold, so a lost one costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.MemoryChange.v1")]
#[repr(C)]
pub struct MemoryChange {
    /// Identity of the store, 128 bits: high and low half.
    pub store_id: [u64; 2],
    /// Newest history sequence.
    pub sequence: u64,
}

const _: () = assert!(size_of::<MemoryChange>() == 24);
