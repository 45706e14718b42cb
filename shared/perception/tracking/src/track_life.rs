//! When a track is believed, and when it is over.

/// A new track is believed after this many frames with a measurement.
const N_SEEN_TO_CONFIRM: u32 = 3;

/// A track not yet believed ends after this long without one.
const TENTATIVE_LOST_NS: u64 = 300_000_000;

/// A believed track of which nothing explains the absence ends after this long.
const UNEXPLAINED_LOST_NS: u64 = 1_500_000_000;

/// A believed track whose place is hidden ends after this long.
const HIDDEN_LOST_NS: u64 = 10_000_000_000;

/// A believed track whose place is outside the image ends after this long.
const OUT_OF_VIEW_LOST_NS: u64 = 60_000_000_000;

/// What the frame shows where a track without measurement is expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Nobody looked, or something is there that is not told from the object.
    Unknown,
    /// What is seen there lies behind the expected box: the object is gone.
    Free,
    /// Something stands before the expected box.
    Hidden,
    /// The expected box lies outside the image.
    OutOfView,
}

/// Whether a track's object was seen in the last frame, and if not, why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// It was seen.
    Seen,
    /// Something stands before it.
    Occluded,
    /// It lies outside the image.
    OutOfView,
    /// It should have been seen.
    Missing,
}

/// How far a track is to be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackPhase {
    /// Seen too seldom; may be noise.
    Tentative,
    /// An object.
    Confirmed,
    /// Over, for ever.
    Lost,
}

/// The record from which a track's phase follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrackLife {
    last_seen_ns: u64,
    /// When it was last seen, or known why it was not.
    last_explained_ns: u64,
    n_seen: u32,
    sight: Sight,
    phase: TrackPhase,
}

impl TrackLife {
    /// The life of a track first seen at a capture stamp.
    pub fn start(stamp_ns: u64) -> Self {
        Self {
            last_seen_ns: stamp_ns,
            last_explained_ns: stamp_ns,
            n_seen: 1,
            sight: Sight::Seen,
            phase: TrackPhase::Tentative,
        }
    }

    /// After a frame with a measurement. A lost track stays lost.
    #[must_use]
    pub fn seen(&self, stamp_ns: u64) -> Self {
        let n_seen = self.n_seen.saturating_add(1);
        let phase = match self.phase {
            TrackPhase::Tentative if n_seen >= N_SEEN_TO_CONFIRM => TrackPhase::Confirmed,
            phase => phase,
        };
        Self {
            last_seen_ns: self.last_seen_ns.max(stamp_ns),
            last_explained_ns: self.last_explained_ns.max(stamp_ns),
            n_seen,
            sight: Sight::Seen,
            phase,
        }
    }

    /// After a frame without a measurement: a place seen empty ends the track at
    /// once, any other in time.
    #[must_use]
    pub fn missed(&self, stamp_ns: u64, place: Place) -> Self {
        let sight = match place {
            Place::Hidden => Sight::Occluded,
            Place::OutOfView => Sight::OutOfView,
            Place::Unknown | Place::Free => Sight::Missing,
        };
        let last_explained_ns = match sight {
            Sight::Missing => self.last_explained_ns,
            _ => self.last_explained_ns.max(stamp_ns),
        };
        let unexplained_ns = stamp_ns.saturating_sub(last_explained_ns);
        let (absent_ns, patience_ns) = match (self.phase, place) {
            (_, Place::Free) | (TrackPhase::Lost, _) => (0, 0),
            (TrackPhase::Tentative, _) => (self.missed_for_ns(stamp_ns), TENTATIVE_LOST_NS),
            (TrackPhase::Confirmed, Place::Unknown) => (unexplained_ns, UNEXPLAINED_LOST_NS),
            (TrackPhase::Confirmed, Place::Hidden) => {
                (self.missed_for_ns(stamp_ns), HIDDEN_LOST_NS)
            }
            (TrackPhase::Confirmed, Place::OutOfView) => {
                (self.missed_for_ns(stamp_ns), OUT_OF_VIEW_LOST_NS)
            }
        };
        let phase = if absent_ns >= patience_ns {
            TrackPhase::Lost
        } else {
            self.phase
        };
        Self {
            last_explained_ns,
            sight,
            phase,
            ..*self
        }
    }

    /// How long the track has been without measurement at a capture stamp.
    pub fn missed_for_ns(&self, stamp_ns: u64) -> u64 {
        stamp_ns.saturating_sub(self.last_seen_ns)
    }

    /// Whether it was seen in the last frame, and if not, why.
    pub fn sight(&self) -> Sight {
        self.sight
    }

    /// How far the track is to be believed.
    pub fn phase(&self) -> TrackPhase {
        self.phase
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TrackPhase::{Confirmed, Lost, Tentative};

    const MS: u64 = 1_000_000;

    fn confirmed_at(stamp_ns: u64) -> TrackLife {
        TrackLife::start(stamp_ns).seen(stamp_ns).seen(stamp_ns)
    }

    #[test]
    fn a_track_is_believed_when_seen_three_times() {
        let life = TrackLife::start(0);
        assert_eq!(life.phase(), Tentative);
        assert_eq!(life.seen(33 * MS).phase(), Tentative);
        assert_eq!(life.seen(33 * MS).seen(66 * MS).phase(), Confirmed);
    }

    #[test]
    fn patience_depends_on_what_is_known_of_the_place() {
        for (place, sight, patience_ms) in [
            (Place::Unknown, Sight::Missing, 1500),
            (Place::Hidden, Sight::Occluded, 10_000),
            (Place::OutOfView, Sight::OutOfView, 60_000),
        ] {
            let life = confirmed_at(700 * MS);
            let alive = life.missed((699 + patience_ms) * MS, place);
            assert_eq!((alive.phase(), alive.sight()), (Confirmed, sight));
            assert_eq!(life.missed((700 + patience_ms) * MS, place).phase(), Lost);
        }
        assert_eq!(confirmed_at(0).missed(33 * MS, Place::Free).phase(), Lost);
        assert_eq!(
            TrackLife::start(0).missed(300 * MS, Place::Unknown).phase(),
            Lost
        );
    }

    #[test]
    fn what_was_hidden_gets_time_to_be_found_again() {
        let hidden = confirmed_at(0).missed(6000 * MS, Place::Hidden);
        let uncovered = hidden.missed(6033 * MS, Place::Unknown);
        assert_eq!(
            (uncovered.phase(), uncovered.sight()),
            (Confirmed, Sight::Missing)
        );
        assert_eq!(uncovered.missed(7500 * MS, Place::Unknown).phase(), Lost);
        assert_eq!(hidden.missed(6033 * MS, Place::Free).phase(), Lost);
    }

    #[test]
    fn a_measurement_renews_patience_but_not_a_lost_track() {
        let life = confirmed_at(0)
            .missed(1400 * MS, Place::Unknown)
            .seen(1450 * MS);
        assert_eq!(life.missed(2900 * MS, Place::Unknown).phase(), Confirmed);
        let lost = confirmed_at(0).missed(1500 * MS, Place::Unknown);
        assert_eq!(lost.seen(1501 * MS).phase(), Lost);
        assert_eq!(lost.missed(1501 * MS, Place::Hidden).phase(), Lost);
    }

    #[test]
    fn a_stamp_that_runs_backwards_ends_nothing() {
        let life = confirmed_at(5000 * MS);
        assert_eq!(life.missed(0, Place::Unknown).phase(), Confirmed);
        assert_eq!(life.seen(0).missed_for_ns(5000 * MS), 0);
    }
}
