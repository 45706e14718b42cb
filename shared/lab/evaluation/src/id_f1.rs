//! IDF1: how much of all that was seen has the right identity (Ristani et al. 2016).

use std::collections::BTreeMap;
use tracking::{AssignmentBuffers, assign};

/// How often each object and each track were seen, and how often at the same place.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct IdentityCounts {
    objects: BTreeMap<u64, u64>,
    tracks: BTreeMap<u64, u64>,
    together: BTreeMap<(u64, u64), u64>,
}

/// What is left when each object has at most one track, the best for all.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct IdentityScore {
    /// Frames in which an object's own track was at its place, over all objects.
    pub n_true_positives: u64,
    /// Frames of all objects.
    pub n_objects: u64,
    /// Frames of all tracks.
    pub n_tracks: u64,
}

impl IdentityScore {
    /// Harmonic mean of the share of the objects and of the tracks that have the
    /// right identity, 0 to 1; `None` without objects and tracks.
    pub fn idf1(&self) -> Option<f64> {
        let n = self.n_objects + self.n_tracks;
        (n > 0).then(|| 2.0 * self.n_true_positives as f64 / n as f64)
    }

    /// Adds the score of another recording, whose identities are others.
    pub fn add(&mut self, other: &Self) {
        self.n_true_positives += other.n_true_positives;
        self.n_objects += other.n_objects;
        self.n_tracks += other.n_tracks;
    }
}

impl IdentityCounts {
    /// Counts an object of a frame.
    pub fn add_object(&mut self, object: u64) {
        *self.objects.entry(object).or_default() += 1;
    }

    /// Counts a track of a frame.
    pub fn add_track(&mut self, track: u64) {
        *self.tracks.entry(track).or_default() += 1;
    }

    /// Counts that a track was at the place of an object, whether or not it was
    /// matched with it.
    pub fn add_together(&mut self, object: u64, track: u64) {
        *self.together.entry((object, track)).or_default() += 1;
    }

    /// Gives each object at most one track, so that the sum of frames together is
    /// greatest.
    pub fn score(&self) -> IdentityScore {
        let most = self.together.values().copied().max().unwrap_or(0) as f64;
        let together = |object: &u64, track: &u64| {
            let n = self.together.get(&(*object, *track));
            n.copied().unwrap_or(0)
        };
        let costs: Vec<f64> = self
            .objects
            .keys()
            .flat_map(|object| {
                let counts = self.tracks.keys().map(|track| together(object, track));
                counts.map(|n| most - n as f64)
            })
            .collect();
        let mut buffers = AssignmentBuffers::default();
        let tracks: Vec<&u64> = self.tracks.keys().collect();
        let pairs = assign(&costs, tracks.len(), most, &mut buffers);
        let pairs = self.objects.keys().zip(pairs);
        let own = pairs.filter_map(|(object, track)| Some(together(object, tracks[(*track)?])));
        IdentityScore {
            n_true_positives: own.sum(),
            n_objects: self.objects.values().sum(),
            n_tracks: self.tracks.values().sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// One track shows one object for some frames.
    fn counts(spans: &[(u64, u64, u64)]) -> IdentityCounts {
        let mut counts = IdentityCounts::default();
        for (object, track, n_frames) in spans {
            for _ in 0..*n_frames {
                counts.add_object(*object);
                counts.add_track(*track);
                counts.add_together(*object, *track);
            }
        }
        counts
    }

    #[test]
    fn an_exchange_costs_what_comes_after_it() {
        let exchanged = counts(&[(1, 7, 6), (2, 8, 6), (1, 8, 4), (2, 7, 4)]);
        assert_eq!(exchanged.score().idf1(), Some(0.6));
    }

    #[test]
    fn the_best_for_all_is_taken_not_the_best_for_one() {
        // 7 with 1 is the longest, but with 2 and 8 with 1 more is right.
        let both = counts(&[(1, 7, 5), (1, 8, 4), (2, 7, 4)]);
        assert_eq!(both.score().n_true_positives, 8);
    }

    #[test]
    fn misses_and_false_positives_count_half() {
        let mut half = counts(&[(1, 7, 10)]);
        (0..10).for_each(|_| half.add_object(1));
        assert_eq!(half.score().idf1(), Some(20.0 / 30.0));
        let mut double = counts(&[(1, 7, 10)]);
        (0..10).for_each(|_| double.add_track(9));
        assert_eq!(double.score().idf1(), Some(20.0 / 30.0));
        assert_eq!(IdentityCounts::default().score().idf1(), None);
    }

    proptest! {
        #[test]
        fn perfect_tracks_have_all_identities(lengths in prop::collection::vec(1..50_u64, 1..8)) {
            let spans: Vec<_> = lengths.iter().zip(1..).map(|(n, id)| (id, id + 20, *n)).collect();
            prop_assert_eq!(counts(&spans).score().idf1(), Some(1.0));
        }

        #[test]
        fn a_track_that_is_broken_keeps_its_longer_part(before in 1..50_u64, after in 1..50_u64) {
            let broken = counts(&[(1, 7, before), (1, 8, after)]);
            let expected = before.max(after) as f64 / (before + after) as f64;
            prop_assert!((broken.score().idf1().unwrap() - expected).abs() < 1e-12);
        }
    }
}
