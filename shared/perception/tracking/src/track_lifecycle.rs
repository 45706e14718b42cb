//! Track lifecycle: confirmation, missed detections and termination.

use crate::visibility::{OcclusionState, Visibility};

/// Number of measurements after which a tentative track is confirmed. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const N_HITS_TO_CONFIRM: u32 = 3;

/// Time without a measurement after which a tentative track is lost, nanoseconds.
/// Chosen; sensitivity: see `tabula-lab sweep`.
const TENTATIVE_TIMEOUT_NS: u64 = 300_000_000;

/// Time without a measurement or an explanation of its absence after which a confirmed
/// track is lost, nanoseconds. Chosen; sensitivity: see `tabula-lab sweep`.
const UNEXPLAINED_TIMEOUT_NS: u64 = 1_500_000_000;

/// Time without a measurement after which an occluded track is lost, nanoseconds.
/// Chosen; sensitivity: see `tabula-lab sweep`.
const OCCLUDED_TIMEOUT_NS: u64 = 10_000_000_000;

/// Time without a measurement after which a track outside the image is lost,
/// nanoseconds. Chosen; sensitivity: see `tabula-lab sweep`.
const OUT_OF_VIEW_TIMEOUT_NS: u64 = 60_000_000_000;

/// Life-cycle phase of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackPhase {
    /// Too few measurements; the track may be noise.
    Tentative,
    /// Track confirmed by repeated measurements.
    Confirmed,
    /// Track has been terminated; it never resumes.
    Lost,
}

/// Life-cycle state machine of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrackLifecycle {
    last_seen_ns: u64,
    /// Stamp of the last measurement or of the last explained absence.
    last_explained_ns: u64,
    n_seen: u32,
    visibility: Visibility,
    phase: TrackPhase,
}

impl TrackLifecycle {
    /// Tentative lifecycle that starts at a capture stamp.
    pub fn start(stamp_ns: u64) -> Self {
        Self {
            last_seen_ns: stamp_ns,
            last_explained_ns: stamp_ns,
            n_seen: 1,
            visibility: Visibility::Visible,
            phase: TrackPhase::Tentative,
        }
    }

    /// Lifecycle after a frame with a measurement. A lost track stays lost.
    #[must_use]
    pub fn observed(&self, stamp_ns: u64) -> Self {
        let n_seen = self.n_seen.saturating_add(1);
        let phase = match self.phase {
            TrackPhase::Tentative if n_seen >= N_HITS_TO_CONFIRM => TrackPhase::Confirmed,
            phase => phase,
        };
        Self {
            last_seen_ns: self.last_seen_ns.max(stamp_ns),
            last_explained_ns: self.last_explained_ns.max(stamp_ns),
            n_seen,
            visibility: Visibility::Visible,
            phase,
        }
    }

    /// Lifecycle after a frame without a measurement. Free space ends the track at once,
    /// any other state after its timeout.
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
        let unexplained_ns = stamp_ns.saturating_sub(last_explained_ns);
        let (absent_ns, timeout_ns) = match (self.phase, occlusion) {
            (_, OcclusionState::Empty) | (TrackPhase::Lost, _) => (0, 0),
            (TrackPhase::Tentative, _) => (self.time_since_seen_ns(stamp_ns), TENTATIVE_TIMEOUT_NS),
            (TrackPhase::Confirmed, OcclusionState::Unknown) => {
                (unexplained_ns, UNEXPLAINED_TIMEOUT_NS)
            }
            (TrackPhase::Confirmed, OcclusionState::Occluded) => {
                (self.time_since_seen_ns(stamp_ns), OCCLUDED_TIMEOUT_NS)
            }
            (TrackPhase::Confirmed, OcclusionState::OutOfView) => {
                (self.time_since_seen_ns(stamp_ns), OUT_OF_VIEW_TIMEOUT_NS)
            }
        };
        let phase = if absent_ns >= timeout_ns {
            TrackPhase::Lost
        } else {
            self.phase
        };
        Self {
            last_explained_ns,
            visibility,
            phase,
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

    /// Life-cycle phase of the track.
    pub fn phase(&self) -> TrackPhase {
        self.phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TrackPhase::{Confirmed, Lost, Tentative};

    const MS: u64 = 1_000_000;

    fn confirmed_at(stamp_ns: u64) -> TrackLifecycle {
        TrackLifecycle::start(stamp_ns)
            .observed(stamp_ns)
            .observed(stamp_ns)
    }

    #[test]
    fn a_track_is_confirmed_after_three_measurements() {
        let lifecycle = TrackLifecycle::start(0);
        assert_eq!(lifecycle.phase(), Tentative);
        assert_eq!(lifecycle.observed(33 * MS).phase(), Tentative);
        assert_eq!(
            lifecycle.observed(33 * MS).observed(66 * MS).phase(),
            Confirmed
        );
    }

    #[test]
    fn the_timeout_depends_on_the_occlusion_state() {
        for (occlusion, visibility, timeout_ms) in [
            (OcclusionState::Unknown, Visibility::Missing, 1500),
            (OcclusionState::Occluded, Visibility::Occluded, 10_000),
            (OcclusionState::OutOfView, Visibility::OutOfView, 60_000),
        ] {
            let lifecycle = confirmed_at(700 * MS);
            let alive = lifecycle.missed((699 + timeout_ms) * MS, occlusion);
            assert_eq!((alive.phase(), alive.visibility()), (Confirmed, visibility));
            assert_eq!(
                lifecycle.missed((700 + timeout_ms) * MS, occlusion).phase(),
                Lost
            );
        }
        assert_eq!(
            confirmed_at(0)
                .missed(33 * MS, OcclusionState::Empty)
                .phase(),
            Lost
        );
        assert_eq!(
            TrackLifecycle::start(0)
                .missed(300 * MS, OcclusionState::Unknown)
                .phase(),
            Lost
        );
    }

    #[test]
    fn an_occluded_track_survives_until_it_is_found_again() {
        let hidden = confirmed_at(0).missed(6000 * MS, OcclusionState::Occluded);
        let uncovered = hidden.missed(6033 * MS, OcclusionState::Unknown);
        assert_eq!(
            (uncovered.phase(), uncovered.visibility()),
            (Confirmed, Visibility::Missing)
        );
        assert_eq!(
            uncovered.missed(7500 * MS, OcclusionState::Unknown).phase(),
            Lost
        );
        assert_eq!(
            hidden.missed(6033 * MS, OcclusionState::Empty).phase(),
            Lost
        );
    }

    #[test]
    fn a_measurement_restarts_the_timeout_but_not_a_lost_track() {
        let lifecycle = confirmed_at(0)
            .missed(1400 * MS, OcclusionState::Unknown)
            .observed(1450 * MS);
        assert_eq!(
            lifecycle.missed(2900 * MS, OcclusionState::Unknown).phase(),
            Confirmed
        );
        let lost = confirmed_at(0).missed(1500 * MS, OcclusionState::Unknown);
        assert_eq!(lost.observed(1501 * MS).phase(), Lost);
        assert_eq!(
            lost.missed(1501 * MS, OcclusionState::Occluded).phase(),
            Lost
        );
    }

    #[test]
    fn a_stamp_that_runs_backwards_ends_nothing() {
        let lifecycle = confirmed_at(5000 * MS);
        assert_eq!(
            lifecycle.missed(0, OcclusionState::Unknown).phase(),
            Confirmed
        );
        assert_eq!(lifecycle.observed(0).time_since_seen_ns(5000 * MS), 0);
    }
}
