//! Upper bound of the shared memory that a whole domain uses.

use crate::{Reservation, topic};

/// Reservations of all services of a domain, for frames of so many points, and with so many
/// guest places.
pub fn domain_reservation(frame_points: usize, guest_places: u32) -> Vec<Reservation> {
    topic::reservations(frame_points, guest_places)
}

/// Upper bound of the shared memory of a domain, bytes, as [`domain_reservation`].
pub fn domain_bytes(frame_points: usize, guest_places: u32) -> u64 {
    let all = domain_reservation(frame_points, guest_places);
    all.iter().map(Reservation::bytes).sum()
}

/// Largest number of guest places, up to a number, with which a domain fits into so many bytes;
/// `None` when it does not fit without any.
pub fn fitting_guest_places(frame_points: usize, most: u32, bytes: u64) -> Option<u32> {
    (0..=most)
        .rev()
        .find(|places| domain_bytes(frame_points, *places) <= bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GUEST_PLACES;
    use crate::topic::{CameraCloud, MAX_FRAME_POINTS, Topic};

    const FRAME_BYTES: u64 = 640 * 480 * 16;

    #[test]
    fn cloud_publisher_reserves_three_frames_for_a_guest() {
        let cloud = |places| topic::reservation::<CameraCloud>(CameraCloud::MAX_ITEMS, places);
        assert_eq!(cloud(0).slots, (2 + 6) + 2);
        assert_eq!(cloud(8).slots, cloud(0).slots + 3 * 8);
        assert!(cloud(8).bytes() < 34 * (FRAME_BYTES + 4096));
    }

    #[test]
    fn domain_of_a_kinect_with_eight_guests_stays_under_450_megabytes() {
        let total = domain_bytes(MAX_FRAME_POINTS, GUEST_PLACES);
        assert!(total < 450_000_000, "{total}");
        let large = domain_bytes(1280 * 720, GUEST_PLACES);
        assert!(large > 2 * total, "{large}");
    }

    #[test]
    fn fitting_places_are_those_that_fit() {
        let bytes = 512 << 20;
        let places = fitting_guest_places(1280 * 720, 32, bytes).unwrap();
        assert!(domain_bytes(1280 * 720, places) <= bytes);
        assert!(domain_bytes(1280 * 720, places + 1) > bytes);
        assert_eq!(fitting_guest_places(1280 * 720, 32, 1000), None);
    }
}
