//! Track lifecycle: confirmation, missed detections and termination.

use crate::visibility::{OcclusionState, Visibility};

/// Existence evidence of a sighting: the logarithm of the ratio of the probabilities that
/// detection finds an object again (9 of 10 frames) and clutter (3 of 10), ln 3. All
/// evidence is in tenths of it. The probabilities are estimates.
const EVIDENCE_OF_SEPARATE: i32 = 10;

/// Existence evidence of a sighting beside a larger cluster: a part of an object that is
/// found apart in one frame is found so again in 8 of 10, ln (0.9 / 0.8).
const EVIDENCE_OF_ADJOINING: i32 = 1;

/// Existence evidence of a frame in which the object should have been seen: ln (0.1 / 0.7).
const EVIDENCE_OF_MISS: i32 = -18;

/// Existence evidence above which a tentative track is confirmed: three separate sightings
/// in a row, or one second beside a larger cluster. By the ratio of 27, 4 % of the clutter is
/// accepted (Wald 1945).
const EVIDENCE_CONFIRMED: i32 = 30;

/// Number of frames with free space in the place of a confirmed track after which its object
/// is gone. One frame is not enough: a wrong camera pose or a depth image with motion blur
/// shows the background beside the object. Chosen.
const N_FRAMES_EMPTY_MAX: u32 = 3;

/// Time without a measurement after which a tentative track is lost, nanoseconds.
/// Chosen.
const TENTATIVE_TIMEOUT_NS: u64 = 300_000_000;

/// Time without a measurement or an explanation of its absence after which a confirmed
/// track is lost, nanoseconds. Its place is not seen empty, so that the object is probably
/// there: a flat object or one at the limit of the range is missed for seconds. Chosen.
const UNEXPLAINED_TIMEOUT_NS: u64 = 10_000_000_000;

/// Time without a measurement after which an occluded track is lost, nanoseconds.
/// Chosen.
const OCCLUDED_TIMEOUT_NS: u64 = 10_000_000_000;

/// Time without a measurement after which a track outside the image is lost,
/// nanoseconds. Chosen.
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

/// Evidence of a sighting for an object of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SightingEvidence {
    /// Cluster apart from all larger ones.
    Separate,
    /// Cluster beside a larger one, of which it may be a part.
    Adjoining,
    /// Cluster that could not begin a track, such as furniture that reaches over the table.
    Contrary,
}

impl SightingEvidence {
    fn value(self) -> i32 {
        match self {
            Self::Separate => EVIDENCE_OF_SEPARATE,
            Self::Adjoining => EVIDENCE_OF_ADJOINING,
            Self::Contrary => EVIDENCE_OF_MISS,
        }
    }
}

/// Life-cycle state machine of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrackLifecycle {
    last_seen_ns: u64,
    /// Stamp of the last measurement or of the last explained absence.
    last_explained_ns: u64,
    /// Evidence for an object, counted while tentative.
    existence: i32,
    /// Number of frames with free space since the last measurement.
    n_frames_empty: u32,
    visibility: Visibility,
    phase: TrackPhase,
}

impl TrackLifecycle {
    /// Tentative lifecycle that starts with a sighting.
    pub fn start(stamp_ns: u64, evidence: SightingEvidence) -> Self {
        Self {
            last_seen_ns: stamp_ns,
            last_explained_ns: stamp_ns,
            existence: evidence.value(),
            n_frames_empty: 0,
            visibility: Visibility::Visible,
            phase: TrackPhase::Tentative,
        }
    }

    /// Lifecycle after a frame with a measurement. A lost track stays lost.
    #[must_use]
    pub fn observed(&self, stamp_ns: u64, evidence: SightingEvidence) -> Self {
        Self {
            last_seen_ns: self.last_seen_ns.max(stamp_ns),
            last_explained_ns: self.last_explained_ns.max(stamp_ns),
            n_frames_empty: 0,
            visibility: Visibility::Visible,
            ..self.with_evidence(evidence.value())
        }
    }

    /// Lifecycle with more evidence for or against an object; confirms or ends a tentative
    /// track (sequential probability ratio test, Wald 1945).
    fn with_evidence(&self, evidence: i32) -> Self {
        let existence = (self.existence + evidence).min(EVIDENCE_CONFIRMED);
        let phase = match self.phase {
            TrackPhase::Tentative if existence >= EVIDENCE_CONFIRMED => TrackPhase::Confirmed,
            TrackPhase::Tentative if existence < 0 => TrackPhase::Lost,
            phase => phase,
        };
        Self {
            existence,
            phase,
            ..*self
        }
    }

    /// Lifecycle that ends with this frame.
    #[must_use]
    pub fn terminated(&self) -> Self {
        Self {
            phase: TrackPhase::Lost,
            ..*self
        }
    }

    /// Lifecycle after a frame without a measurement. Free space ends a tentative track at
    /// once and a confirmed one after several frames, any other state after its timeout.
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
        let should_be_seen = visibility == Visibility::Missing;
        let judged = self.with_evidence(if should_be_seen { EVIDENCE_OF_MISS } else { 0 });
        let n_frames_empty = self
            .n_frames_empty
            .saturating_add(u32::from(occlusion == OcclusionState::Empty));
        let unexplained_ns = stamp_ns.saturating_sub(last_explained_ns);
        let (absent_ns, timeout_ns) = match (judged.phase, occlusion) {
            (TrackPhase::Tentative, OcclusionState::Empty) | (TrackPhase::Lost, _) => (0, 0),
            (TrackPhase::Tentative, _) => (self.time_since_seen_ns(stamp_ns), TENTATIVE_TIMEOUT_NS),
            (TrackPhase::Confirmed, OcclusionState::Empty)
                if n_frames_empty >= N_FRAMES_EMPTY_MAX =>
            {
                (0, 0)
            }
            (TrackPhase::Confirmed, OcclusionState::Unknown | OcclusionState::Empty) => {
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
            judged.phase
        };
        Self {
            last_explained_ns,
            n_frames_empty,
            visibility,
            phase,
            ..judged
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
    use SightingEvidence::{Adjoining, Contrary, Separate};
    use TrackPhase::{Confirmed, Lost, Tentative};

    const MS: u64 = 1_000_000;

    fn confirmed_at(stamp_ns: u64) -> TrackLifecycle {
        TrackLifecycle::start(stamp_ns, Separate)
            .observed(stamp_ns, Separate)
            .observed(stamp_ns, Separate)
    }

    #[test]
    fn a_track_is_confirmed_after_three_measurements() {
        let lifecycle = TrackLifecycle::start(0, Separate);
        assert_eq!(lifecycle.phase(), Tentative);
        assert_eq!(lifecycle.observed(33 * MS, Separate).phase(), Tentative);
        assert_eq!(
            lifecycle
                .observed(33 * MS, Separate)
                .observed(66 * MS, Separate)
                .phase(),
            Confirmed
        );
    }

    #[test]
    fn the_timeout_depends_on_the_occlusion_state() {
        for (occlusion, visibility, timeout_ms) in [
            (OcclusionState::Unknown, Visibility::Missing, 10_000),
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
            TrackLifecycle::start(0, Separate)
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
            uncovered
                .missed(16_000 * MS, OcclusionState::Unknown)
                .phase(),
            Lost
        );
    }

    #[test]
    fn free_space_ends_a_confirmed_track_after_three_frames() {
        let empty = |lifecycle: TrackLifecycle, frame: u64| {
            lifecycle.missed(frame * 33 * MS, OcclusionState::Empty)
        };
        let twice = empty(empty(confirmed_at(0), 1), 2);
        assert_eq!(
            (twice.phase(), twice.visibility()),
            (Confirmed, Visibility::Missing)
        );
        assert_eq!(empty(twice, 3).phase(), Lost);
        // The frames add up, whatever lies between them, until the object is seen again.
        let hidden = twice.missed(99 * MS, OcclusionState::Occluded);
        assert_eq!(empty(hidden, 4).phase(), Lost);
        assert_eq!(
            empty(twice.observed(99 * MS, Separate), 4).phase(),
            Confirmed
        );
        assert_eq!(empty(TrackLifecycle::start(0, Separate), 1).phase(), Lost);
    }

    #[test]
    fn existence_evidence_of_a_tentative_track_adds_up() {
        let missed = |lifecycle: TrackLifecycle| lifecycle.missed(9 * MS, OcclusionState::Unknown);
        let seen = |lifecycle: TrackLifecycle| lifecycle.observed(9 * MS, Separate);
        // Seen in two of three frames: not an object.
        let twice = seen(TrackLifecycle::start(0, Separate));
        assert_eq!(missed(twice).phase(), Tentative);
        assert_eq!(missed(seen(missed(twice))).phase(), Lost);
        assert_eq!(missed(TrackLifecycle::start(0, Separate)).phase(), Lost);
        // A cluster that could not begin a track is no evidence for one.
        let at_rim = twice.observed(9 * MS, Contrary);
        assert_eq!(at_rim.phase(), Tentative);
        assert_eq!(at_rim.observed(9 * MS, Contrary).phase(), Lost);
        // A part of a larger object has to be found apart for a second.
        let mut part = TrackLifecycle::start(0, Adjoining);
        for _ in 0..28 {
            part = part.observed(9 * MS, Adjoining);
        }
        assert_eq!(
            (part.phase(), missed(missed(part)).phase()),
            (Tentative, Lost)
        );
        assert_eq!(part.observed(9 * MS, Adjoining).phase(), Confirmed);
        // An occlusion is no evidence at all; a confirmed track needs none.
        let hidden = TrackLifecycle::start(0, Separate).missed(9 * MS, OcclusionState::Occluded);
        assert_eq!(hidden.phase(), Tentative);
        let carried = confirmed_at(0)
            .observed(9 * MS, Contrary)
            .observed(9 * MS, Contrary);
        assert_eq!(carried.phase(), Confirmed);
        assert_eq!(confirmed_at(0).terminated().phase(), Lost);
    }

    #[test]
    fn a_measurement_restarts_the_timeout_but_not_a_lost_track() {
        let lifecycle = confirmed_at(0)
            .missed(9_900 * MS, OcclusionState::Unknown)
            .observed(9_950 * MS, Separate);
        assert_eq!(
            lifecycle
                .missed(19_900 * MS, OcclusionState::Unknown)
                .phase(),
            Confirmed
        );
        let lost = confirmed_at(0).missed(10_000 * MS, OcclusionState::Unknown);
        assert_eq!(lost.observed(10_001 * MS, Separate).phase(), Lost);
        assert_eq!(
            lost.missed(10_001 * MS, OcclusionState::Occluded).phase(),
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
        assert_eq!(
            lifecycle
                .observed(0, Separate)
                .time_since_seen_ns(5000 * MS),
            0
        );
    }
}
