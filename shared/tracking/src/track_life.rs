//! When a track is believed, and when it is over.

/// A new track is believed after this many frames with a measurement.
const N_SEEN_TO_CONFIRM: u32 = 3;

/// A track not yet believed ends after this long without one.
const TENTATIVE_LOST_NS: u64 = 300_000_000;

/// A believed track ends after this long without one.
const CONFIRMED_LOST_NS: u64 = 1_500_000_000;

/// A believed track whose place is hidden ends after this long without one.
const HIDDEN_LOST_NS: u64 = 10_000_000_000;

/// What the frame shows where a track without measurement is expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Nobody looked.
    Unknown,
    /// What is seen there lies behind the expected box: the object is gone.
    Free,
    /// Something stands before the expected box.
    Hidden,
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
    n_seen: u32,
    phase: TrackPhase,
}

impl TrackLife {
    /// The life of a track first seen at a capture stamp.
    pub fn start(stamp_ns: u64) -> Self {
        Self {
            last_seen_ns: stamp_ns,
            n_seen: 1,
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
            n_seen,
            phase,
        }
    }

    /// After a frame without a measurement.
    #[must_use]
    pub fn missed(&self, stamp_ns: u64, place: Place) -> Self {
        let patience_ns = match (self.phase, place) {
            (_, Place::Free) | (TrackPhase::Lost, _) => 0,
            (TrackPhase::Tentative, _) => TENTATIVE_LOST_NS,
            (TrackPhase::Confirmed, Place::Unknown) => CONFIRMED_LOST_NS,
            (TrackPhase::Confirmed, Place::Hidden) => HIDDEN_LOST_NS,
        };
        let is_over = self.missed_for_ns(stamp_ns) >= patience_ns;
        Self {
            phase: if is_over {
                TrackPhase::Lost
            } else {
                self.phase
            },
            ..*self
        }
    }

    /// How long the track has been without measurement at a capture stamp.
    pub fn missed_for_ns(&self, stamp_ns: u64) -> u64 {
        stamp_ns.saturating_sub(self.last_seen_ns)
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
        for (place, last_alive_ms, lost_ms) in
            [(Place::Unknown, 1499, 1500), (Place::Hidden, 9999, 10_000)]
        {
            let life = confirmed_at(700 * MS);
            assert_eq!(
                life.missed((700 + last_alive_ms) * MS, place).phase(),
                Confirmed
            );
            assert_eq!(life.missed((700 + lost_ms) * MS, place).phase(), Lost);
        }
        assert_eq!(confirmed_at(0).missed(33 * MS, Place::Free).phase(), Lost);
        assert_eq!(
            TrackLife::start(0).missed(300 * MS, Place::Unknown).phase(),
            Lost
        );
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
