//! Existence test of a new object: sequential probability ratio test over the frames in which it
//! was found and missed (Wald 1945).
//!
//! All evidence is in tenths of the natural logarithm of a likelihood ratio. The probabilities
//! are estimates.

/// Evidence of a sighting of a separate object: detection finds an object again in 9 of 10
/// frames and clutter in 3 of 10, ln 3.
const SEPARATE_SIGHTED: i32 = 10;

/// Evidence of a frame in which a separate object should have been seen: ln (0.1 / 0.7).
const SEPARATE_MISSED: i32 = -18;

/// Evidence of a sighting beside a larger cluster: an object there is found in 95 of 100 frames,
/// a part of the larger one is found apart in 78, ln (0.95 / 0.78).
const ADJOINING_SIGHTED: i32 = 2;

/// Evidence of a frame in which an object beside a larger cluster should have been seen:
/// ln (0.05 / 0.22).
const ADJOINING_MISSED: i32 = -15;

/// Evidence against an arrival in a scene at rest. The frames of such a scene repeat one another,
/// so that another cut through it lasts: odds of 1 to 100 million make it wait for three and a half
/// seconds beside a larger cluster. Chosen.
const AT_REST: i32 = 184;

/// Evidence from which there is an object: three separate sightings in a row, or half a
/// second beside a larger cluster. By the ratio of 20, 5 % of the clutter is accepted.
const ACCEPTED: i32 = 30;

/// Evidence up to which there is none; 5 % of the objects are rejected, and start anew.
const REJECTED: i32 = -30;

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
    fn sighted(self) -> i32 {
        match self {
            Self::Separate => SEPARATE_SIGHTED,
            Self::Adjoining => ADJOINING_SIGHTED,
            Self::Contrary => SEPARATE_MISSED,
        }
    }

    fn missed(self) -> i32 {
        match self {
            Self::Separate | Self::Contrary => SEPARATE_MISSED,
            Self::Adjoining => ADJOINING_MISSED,
        }
    }
}

/// Prior probability of an arrival.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArrivalPrior {
    /// Even odds: the scene is new, or something moved a moment ago.
    Even,
    /// Unlikely: nothing has moved, so that what looks new is probably another cut through what was
    /// there. 22 separate sightings in a row are an object then, and 107 beside a larger cluster.
    SceneAtRest,
}

impl ArrivalPrior {
    /// Evidence from which there is an object.
    fn accepted(self) -> i32 {
        match self {
            Self::Even => ACCEPTED,
            Self::SceneAtRest => ACCEPTED + AT_REST,
        }
    }
}

/// State of an existence test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existence {
    /// Too little evidence so far.
    Undecided,
    /// There is an object.
    Accepted,
    /// There is none.
    Rejected,
}

/// Existence test of one object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExistenceTest {
    evidence: i32,
    last_sighting: SightingEvidence,
}

impl ExistenceTest {
    /// Test that starts with a sighting.
    pub fn start(sighting: SightingEvidence) -> Self {
        Self {
            evidence: sighting.sighted(),
            last_sighting: sighting,
        }
    }

    /// Test after a frame with a sighting.
    #[must_use]
    pub fn sighted(&self, sighting: SightingEvidence) -> Self {
        Self {
            evidence: self.evidence + sighting.sighted(),
            last_sighting: sighting,
        }
    }

    /// Test after a frame in which the object should have been seen, and was not.
    #[must_use]
    pub fn missed(&self) -> Self {
        Self {
            evidence: self.evidence + self.last_sighting.missed(),
            ..*self
        }
    }

    /// Decision so far, by the present prior.
    pub fn existence(&self, prior: ArrivalPrior) -> Existence {
        if self.evidence >= prior.accepted() {
            Existence::Accepted
        } else if self.evidence <= REJECTED {
            Existence::Rejected
        } else {
            Existence::Undecided
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ArrivalPrior::{Even, SceneAtRest};
    use super::Existence::{Accepted, Rejected, Undecided};
    use super::SightingEvidence::{Adjoining, Contrary, Separate};
    use super::*;

    #[test]
    fn three_separate_sightings_in_a_row_are_an_object() {
        let once = ExistenceTest::start(Separate);
        assert_eq!(once.existence(Even), Undecided);
        assert_eq!(once.missed().existence(Even), Undecided);
        assert_eq!(once.missed().missed().missed().existence(Even), Rejected);
        let twice = once.sighted(Separate);
        assert_eq!(twice.existence(Even), Undecided);
        assert_eq!(twice.sighted(Separate).existence(Even), Accepted);
        // Seen in every other frame: not an object.
        let flickering = (0..5).fold(once, |test, _| test.missed().sighted(Separate));
        assert_eq!(flickering.missed().existence(Even), Rejected);
    }

    #[test]
    fn sightings_that_could_not_begin_a_track_speak_against_one() {
        let at_rim = ExistenceTest::start(Separate)
            .sighted(Separate)
            .sighted(Contrary);
        assert_eq!(at_rim.existence(Even), Undecided);
        let stays_there = at_rim.sighted(Contrary).sighted(Contrary);
        assert_eq!(stays_there.existence(Even), Rejected);
    }

    #[test]
    fn part_of_a_larger_object_has_to_be_found_apart_for_half_a_second() {
        let mut part = ExistenceTest::start(Adjoining);
        for _ in 0..13 {
            part = part.sighted(Adjoining);
        }
        assert_eq!(part.existence(Even), Undecided);
        assert_eq!(part.sighted(Adjoining).existence(Even), Accepted);
    }

    #[test]
    fn part_that_is_found_in_three_of_four_frames_is_rejected() {
        let mut part = ExistenceTest::start(Adjoining);
        let mut n_frames = 0;
        while part.existence(Even) == Undecided && n_frames < 100 {
            n_frames += 1;
            part = if n_frames % 4 == 0 {
                part.missed()
            } else {
                part.sighted(Adjoining)
            };
        }
        assert_eq!(part.existence(Even), Rejected, "after {n_frames} frames");
    }

    #[test]
    fn arrivals_in_a_scene_at_rest_need_more_sightings() {
        let n_sightings = |evidence: SightingEvidence| {
            let mut test = ExistenceTest::start(evidence);
            let mut n_sightings = 1;
            while test.existence(SceneAtRest) == Undecided {
                n_sightings += 1;
                test = test.sighted(evidence);
            }
            n_sightings
        };
        assert_eq!([Separate, Adjoining].map(n_sightings), [22, 107]);
    }
}
