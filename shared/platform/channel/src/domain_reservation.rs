//! Upper bound of the shared memory that a whole domain uses.

use crate::{Reservation, request_services, topic};

/// Reservations of all services of a domain.
pub fn domain_reservation() -> Vec<Reservation> {
    let mut all = topic::reservations();
    all.extend(request_services::reservations());
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topic::{CameraCloud, Topic};

    #[test]
    fn cloud_publisher_reserves_the_slots_of_its_limits() {
        let cloud = topic::reservation::<CameraCloud>(CameraCloud::MAX_ITEMS);
        assert_eq!(cloud.slots, 3 * (2 + 6) + 2);
        assert!(cloud.bytes() > 26 * 4_915_200 && cloud.bytes() < 26 * 4_925_000);
        let total: u64 = domain_reservation().iter().map(Reservation::bytes).sum();
        assert!(total > cloud.bytes() && total < 264_000_000, "{total}");
    }
}
