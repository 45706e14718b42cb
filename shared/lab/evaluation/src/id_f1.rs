//! IDF1: F1 of identities over a whole sequence (Ristani et al. 2016).

use std::collections::BTreeMap;
use tracking::{AssignmentBuffers, assign};

/// Frame counts of each object, each track, and each pair at the same position.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct IdentityCounts {
    objects: BTreeMap<u64, u64>,
    tracks: BTreeMap<u64, u64>,
    common_frames: BTreeMap<(u64, u64), u64>,
}

/// Identity score under the best global one-to-one assignment of tracks to objects.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct IdentityScore {
    /// Identity true positives (IDTP): frames in which an object's assigned track was at its
    /// position.
    pub n_true_positives: u64,
    /// Number of object-frames: total frames of all objects.
    pub n_objects: u64,
    /// Number of track-frames: total frames of all tracks.
    pub n_tracks: u64,
}

impl IdentityScore {
    /// IDF1, 0 to 1: harmonic mean of identity precision and recall; `None` without objects and
    /// tracks.
    pub fn idf1(&self) -> Option<f64> {
        let n = self.n_objects + self.n_tracks;
        (n > 0).then(|| 2.0 * self.n_true_positives as f64 / n as f64)
    }

    /// Adds the score of another sequence with other identities.
    pub fn add(&mut self, other: &Self) {
        self.n_true_positives += other.n_true_positives;
        self.n_objects += other.n_objects;
        self.n_tracks += other.n_tracks;
    }
}

impl IdentityCounts {
    /// Counts one frame in which an object was present.
    pub fn add_object(&mut self, object: u64) {
        *self.objects.entry(object).or_default() += 1;
    }

    /// Counts one frame in which a track was present.
    pub fn add_track(&mut self, track: u64) {
        *self.tracks.entry(track).or_default() += 1;
    }

    /// Counts a frame in which a track was within the gate of an object, matched or not.
    pub fn add_common_frame(&mut self, object: u64, track: u64) {
        *self.common_frames.entry((object, track)).or_default() += 1;
    }

    /// Best one-to-one assignment: maximises the total number of common frames.
    pub fn score(&self) -> IdentityScore {
        let most = self.common_frames.values().copied().max().unwrap_or(0) as f64;
        let common_frames = |object: &u64, track: &u64| {
            let n = self.common_frames.get(&(*object, *track));
            n.copied().unwrap_or(0)
        };
        let costs: Vec<f64> = self
            .objects
            .keys()
            .flat_map(|object| {
                let counts = self.tracks.keys().map(|track| common_frames(object, track));
                counts.map(|n| most - n as f64)
            })
            .collect();
        let mut buffers = AssignmentBuffers::default();
        let tracks: Vec<&u64> = self.tracks.keys().collect();
        let pairs = assign(&costs, tracks.len(), most, &mut buffers);
        let pairs = self.objects.keys().zip(pairs);
        let own =
            pairs.filter_map(|(object, track)| Some(common_frames(object, tracks[(*track)?])));
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

    /// Counts of spans `(object, track, n_frames)` in which a track shows an object.
    fn counts(spans: &[(u64, u64, u64)]) -> IdentityCounts {
        let mut counts = IdentityCounts::default();
        for (object, track, n_frames) in spans {
            for _ in 0..*n_frames {
                counts.add_object(*object);
                counts.add_track(*track);
                counts.add_common_frame(*object, *track);
            }
        }
        counts
    }

    #[test]
    fn identity_swap_costs_the_frames_after_it() {
        let exchanged = counts(&[(1, 7, 6), (2, 8, 6), (1, 8, 4), (2, 7, 4)]);
        assert_eq!(exchanged.score().idf1(), Some(0.6));
    }

    #[test]
    fn assignment_is_globally_optimal() {
        // Greedy matching of 7 with 1 would leave fewer right frames in total.
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
        fn fragmented_track_keeps_its_longer_part(before in 1..50_u64, after in 1..50_u64) {
            let broken = counts(&[(1, 7, before), (1, 8, after)]);
            let expected = before.max(after) as f64 / (before + after) as f64;
            prop_assert!((broken.score().idf1().unwrap() - expected).abs() < 1e-12);
        }
    }
}
