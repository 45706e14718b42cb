//! Track lifecycle: missed detections and termination.

use crate::visibility::{OcclusionState, Visibility};

/// Number of frames with free space in the place of a track after which its object
/// is gone. One frame is not enough: a wrong camera pose or a depth image with motion blur
/// shows the background beside the object. Chosen.
const N_FRAMES_EMPTY_MAX: u32 = 3;

/// Time without a measurement or an explanation of its absence after which a track
/// is lost, nanoseconds. Its place is not seen empty, so that the object is probably
/// there: a flat object or one at the limit of the range is missed for seconds. Chosen.
const UNEXPLAINED_TIMEOUT_NS: u64 = 10_000_000_000;

/// Time without a measurement after which an occluded track is lost, nanoseconds.
/// Chosen.
const OCCLUDED_TIMEOUT_NS: u64 = 10_000_000_000;

/// Time without a measurement after which a track outside the image is lost,
/// nanoseconds. Chosen.
const OUT_OF_VIEW_TIMEOUT_NS: u64 = 60_000_000_000;

/// Life-cycle state machine of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrackLifecycle {
    last_seen_ns: u64,
    /// Stamp of the last measurement or of the last explained absence.
    last_explained_ns: u64,
    /// Number of frames with free space since the last measurement.
    n_frames_empty: u32,
    visibility: Visibility,
    is_lost: bool,
}

impl TrackLifecycle {
    /// Lifecycle that starts with a sighting.
    pub fn start(stamp_ns: u64) -> Self {
        Self {
            last_seen_ns: stamp_ns,
            last_explained_ns: stamp_ns,
            n_frames_empty: 0,
            visibility: Visibility::Visible,
            is_lost: false,
        }
    }

    /// Lifecycle after a frame with a measurement. A lost track stays lost.
    #[must_use]
    pub fn observed(&self, stamp_ns: u64) -> Self {
        Self {
            last_seen_ns: self.last_seen_ns.max(stamp_ns),
            last_explained_ns: self.last_explained_ns.max(stamp_ns),
            n_frames_empty: 0,
            visibility: Visibility::Visible,
            is_lost: self.is_lost,
        }
    }

    /// Lifecycle that ends with this frame.
    #[must_use]
    pub fn terminated(&self) -> Self {
        Self {
            is_lost: true,
            ..*self
        }
    }

    /// Lifecycle after a frame without a measurement. Free space ends a track after several
    /// frames, any other state after its timeout.
    #[must_use]
    pub fn missed(&self, stamp_ns: u64, occlusion: OcclusionState) -> Self {
        let visibility = match occlusion {
            OcclusionState::Occluded => Visibility::Occluded,
            OcclusionState::OutOfView => Visibility::OutOfView,
            OcclusionState::Unknown | OcclusionState::Empty => Visibility::Missing,
        };
        let last_explained_ns = match visibility {
            Visibility::Missing => self.last_explained_ns,
            _ => self.last_explained_ns.max(stamp_ns),
        };
        let n_frames_empty = self
            .n_frames_empty
            .saturating_add(u32::from(occlusion == OcclusionState::Empty));
        let unseen_ns = self.time_since_seen_ns(stamp_ns);
        let is_over = match occlusion {
            OcclusionState::Empty if n_frames_empty >= N_FRAMES_EMPTY_MAX => true,
            OcclusionState::Unknown | OcclusionState::Empty => {
                stamp_ns.saturating_sub(last_explained_ns) >= UNEXPLAINED_TIMEOUT_NS
            }
            OcclusionState::Occluded => unseen_ns >= OCCLUDED_TIMEOUT_NS,
            OcclusionState::OutOfView => unseen_ns >= OUT_OF_VIEW_TIMEOUT_NS,
        };
        Self {
            last_explained_ns,
            n_frames_empty,
            visibility,
            is_lost: self.is_lost || is_over,
            ..*self
        }
    }

    /// Time since the last measurement at a capture stamp, nanoseconds.
    pub fn time_since_seen_ns(&self, stamp_ns: u64) -> u64 {
        stamp_ns.saturating_sub(self.last_seen_ns)
    }

    /// Visibility of the object in the last frame.
    pub fn visibility(&self) -> Visibility {
        self.visibility
    }

    /// True for a track that has been terminated; it never resumes.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn the_timeout_depends_on_the_occlusion_state() {
        for (occlusion, visibility, timeout_ms) in [
            (OcclusionState::Unknown, Visibility::Missing, 10_000),
            (OcclusionState::Occluded, Visibility::Occluded, 10_000),
            (OcclusionState::OutOfView, Visibility::OutOfView, 60_000),
        ] {
            let lifecycle = TrackLifecycle::start(700 * MS);
            let alive = lifecycle.missed((699 + timeout_ms) * MS, occlusion);
            assert_eq!((alive.is_lost(), alive.visibility()), (false, visibility));
            assert!(
                lifecycle
                    .missed((700 + timeout_ms) * MS, occlusion)
                    .is_lost()
            );
        }
    }

    #[test]
    fn an_occluded_track_survives_until_it_is_found_again() {
        let hidden = TrackLifecycle::start(0).missed(6000 * MS, OcclusionState::Occluded);
        let uncovered = hidden.missed(6033 * MS, OcclusionState::Unknown);
        assert_eq!(
            (uncovered.is_lost(), uncovered.visibility()),
            (false, Visibility::Missing)
        );
        let late = uncovered.missed(16_000 * MS, OcclusionState::Unknown);
        assert!(late.is_lost());
    }

    #[test]
    fn free_space_ends_a_track_after_three_frames() {
        let empty = |lifecycle: TrackLifecycle, frame: u64| {
            lifecycle.missed(frame * 33 * MS, OcclusionState::Empty)
        };
        let twice = empty(empty(TrackLifecycle::start(0), 1), 2);
        assert_eq!(
            (twice.is_lost(), twice.visibility()),
            (false, Visibility::Missing)
        );
        assert!(empty(twice, 3).is_lost());
        // The frames add up, whatever lies between them, until the object is seen again.
        let hidden = twice.missed(99 * MS, OcclusionState::Occluded);
        assert!(empty(hidden, 4).is_lost());
        assert!(!empty(twice.observed(99 * MS), 4).is_lost());
        assert!(TrackLifecycle::start(0).terminated().is_lost());
    }

    #[test]
    fn a_measurement_restarts_the_timeout_but_not_a_lost_track() {
        let lifecycle = TrackLifecycle::start(0)
            .missed(9_900 * MS, OcclusionState::Unknown)
            .observed(9_950 * MS);
        assert!(
            !lifecycle
                .missed(19_900 * MS, OcclusionState::Unknown)
                .is_lost()
        );
        let lost = TrackLifecycle::start(0).missed(10_000 * MS, OcclusionState::Unknown);
        assert!(lost.observed(10_001 * MS).is_lost());
        assert!(lost.missed(10_001 * MS, OcclusionState::Occluded).is_lost());
    }

    #[test]
    fn a_stamp_that_runs_backwards_ends_nothing() {
        let lifecycle = TrackLifecycle::start(5000 * MS);
        assert!(!lifecycle.missed(0, OcclusionState::Unknown).is_lost());
        assert_eq!(lifecycle.observed(0).time_since_seen_ns(5000 * MS), 0);
    }
}
