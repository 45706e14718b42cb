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

impl MemoryChange {
    /// Notification of a position in the history of a store.
    pub fn new(store_id: u128, sequence: u64) -> Self {
        Self {
            store_id: [(store_id >> 64) as u64, store_id as u64],
            sequence,
        }
    }

    /// Identity of the store.
    pub fn store_id(&self) -> u128 {
        let [high, low] = self.store_id;
        u128::from(high) << 64 | u128::from(low)
    }
}

const _: () = assert!(size_of::<MemoryChange>() == 24);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn store_id_is_kept_in_two_halves() {
        let change = MemoryChange::new((1 << 64) + 7, 9);
        assert_eq!((change.store_id, change.sequence), ([1, 7], 9));
        assert_eq!(change.store_id(), (1 << 64) + 7);
    }
}
