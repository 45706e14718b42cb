//! How much shared memory a domain can come to use.

use crate::control::shared_memory::reservations as control_reservations;
use crate::topic::{self, Topic};

/// Shared memory that the ports of one service reserve at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reservation {
    /// The service.
    pub service: &'static str,
    /// Message slots of all its senders.
    pub slots: u64,
    /// Bytes of one slot.
    pub slot_bytes: u64,
}

/// iceoryx2 puts a header of its own before each payload, and aligns.
const SLOT_OVERHEAD_BYTES: u64 = 128;

impl Reservation {
    /// Of a publish-subscribe service: a publisher keeps one slot for each message
    /// that can wait at or be held by a subscriber, for its history and its loans.
    pub(crate) fn of_topic<T: Topic>() -> Self {
        let limits = T::LIMITS;
        let slots =
            limits.subscribers * (limits.buffer + limits.borrowed) + limits.history + limits.loaned;
        let bytes = size_of::<T::Header>() + T::MAX_ITEMS * size_of::<T::Item>();
        Self {
            service: T::NAME,
            slots: (slots * limits.publishers) as u64,
            slot_bytes: bytes as u64 + SLOT_OVERHEAD_BYTES,
        }
    }

    /// Bytes of all slots.
    pub fn bytes(&self) -> u64 {
        self.slots * self.slot_bytes
    }
}

/// All services of a domain.
pub fn domain_reservation() -> Vec<Reservation> {
    let mut all = topic::reservations();
    all.extend(control_reservations());
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topic::CameraCloud;

    #[test]
    fn a_cloud_publisher_reserves_what_its_limits_say() {
        let cloud = Reservation::of_topic::<CameraCloud>();
        assert_eq!(cloud.slots, 3 * (2 + 6) + 2);
        assert!(cloud.bytes() > 26 * 4_915_200 && cloud.bytes() < 26 * 4_925_000);
        let total: u64 = domain_reservation().iter().map(Reservation::bytes).sum();
        assert!(total > cloud.bytes() && total < 250_000_000, "{total}");
    }
}
