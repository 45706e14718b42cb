//! CLEAR MOT metrics: frame-by-frame correspondence of tracks and ground truth, and MOTA
//! (Bernardin and Stiefelhagen 2008).

use nalgebra::Point3;
use std::collections::BTreeMap;
use tracking::{AssignmentBuffers, assign};

/// Cost of leaving an object unmatched; large enough that the assignment matches as many as
/// possible.
const UNMATCHED_COST: f64 = 1e6;

/// Position of an object or a track in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScoredPosition {
    /// Object number or track-id.
    pub id: u64,
    /// Position of the object or track in the world frame, metres.
    pub position: Point3<f64>,
    /// `true` if it is scored: an object that is not scored is no miss, and a track matched with
    /// it is no false positive.
    pub counts: bool,
}

/// Matched pair of object and track, by index in the frame's lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Match {
    /// Index of the matched object in the frame's object list.
    pub object: usize,
    /// Index of the matched track in the frame's track list.
    pub track: usize,
}

/// CLEAR MOT counts summed over frames.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ClearMot {
    /// Scored objects (ground-truth boxes) over all frames.
    pub n_objects: u64,
    /// Tracks over all frames, except those matched with an object that is not scored.
    pub n_tracks: u64,
    /// Misses: scored objects without a track.
    pub n_misses: u64,
    /// False positives: tracks without an object.
    pub n_false_positives: u64,
    /// Identity switches: scored objects matched with another track than the last time they were
    /// scored.
    pub n_switches: u64,
}

impl ClearMot {
    /// Multiple object tracking accuracy: at most 1, possibly negative; `None` without objects.
    pub fn mota(&self) -> Option<f64> {
        let n_errors = self.n_misses + self.n_false_positives + self.n_switches;
        (self.n_objects > 0).then(|| 1.0 - n_errors as f64 / self.n_objects as f64)
    }

    /// Adds the counts of other frames.
    pub fn add(&mut self, other: &Self) {
        self.n_objects += other.n_objects;
        self.n_tracks += other.n_tracks;
        self.n_misses += other.n_misses;
        self.n_false_positives += other.n_false_positives;
        self.n_switches += other.n_switches;
    }
}

/// Frame-to-frame correspondence of objects and tracks.
#[derive(Debug, Default)]
pub struct Correspondence {
    gate_m: f64,
    sums: ClearMot,
    /// Track that was last matched with each object.
    last: BTreeMap<u64, u64>,
    /// Track last matched with each object while it was scored.
    last_counted: BTreeMap<u64, u64>,
    costs: Vec<f64>,
    buffers: AssignmentBuffers,
    matches: Vec<Match>,
}

impl Correspondence {
    /// Correspondence with a gate: pairs farther apart than `gate_m` are never matched.
    pub fn new(gate_m: f64) -> Self {
        Self {
            gate_m,
            ..Self::default()
        }
    }

    /// CLEAR MOT counts of the frames so far.
    pub fn sums(&self) -> ClearMot {
        self.sums
    }

    /// Matches the objects and tracks of the next frame. Previous matches are kept within the
    /// gate; the rest are assigned one to one, as many as possible and with the least sum of
    /// distances.
    pub fn step(&mut self, objects: &[ScoredPosition], tracks: &[ScoredPosition]) -> &[Match] {
        self.matches.clear();
        self.keep(objects, tracks);
        self.assign_others(objects, tracks);
        self.count(objects, tracks);
        for Match { object, track } in &self.matches {
            self.last.insert(objects[*object].id, tracks[*track].id);
        }
        &self.matches
    }

    fn keep(&mut self, objects: &[ScoredPosition], tracks: &[ScoredPosition]) {
        for (object, scored_position) in objects.iter().enumerate() {
            let Some(last) = self.last.get(&scored_position.id) else {
                continue;
            };
            let track = tracks.iter().position(|track| track.id == *last);
            let is_free = |track: &usize| self.matches.iter().all(|other| other.track != *track);
            if let Some(track) = track.filter(is_free)
                && self.is_near(scored_position, &tracks[track])
            {
                self.matches.push(Match { object, track });
            }
        }
    }

    fn assign_others(&mut self, objects: &[ScoredPosition], tracks: &[ScoredPosition]) {
        let kept = self.matches.clone();
        self.costs.clear();
        for (object, scored_position) in objects.iter().enumerate() {
            for (track, found) in tracks.iter().enumerate() {
                let is_taken = kept
                    .iter()
                    .any(|other| other.object == object || other.track == track);
                let is_possible = !is_taken && self.is_near(scored_position, found);
                let distance_m = (scored_position.position - found.position).norm();
                self.costs.push(if is_possible {
                    distance_m
                } else {
                    f64::INFINITY
                });
            }
        }
        let pairs = assign(&self.costs, tracks.len(), UNMATCHED_COST, &mut self.buffers);
        let pairs = pairs.iter().enumerate();
        self.matches.extend(pairs.filter_map(|(object, track)| {
            Some(Match {
                object,
                track: (*track)?,
            })
        }));
    }

    fn count(&mut self, objects: &[ScoredPosition], tracks: &[ScoredPosition]) {
        let sums = &mut self.sums;
        let n_objects = objects.iter().filter(|object| object.counts).count();
        let n_counted = self.matches.iter().filter(|m| objects[m.object].counts);
        sums.n_objects += n_objects as u64;
        sums.n_misses += (n_objects - n_counted.count()) as u64;
        sums.n_false_positives += (tracks.len() - self.matches.len()) as u64;
        for Match { object, track } in &self.matches {
            let (object, track) = (&objects[*object], &tracks[*track]);
            if !object.counts {
                continue;
            }
            let before = self.last_counted.insert(object.id, track.id);
            sums.n_switches += u64::from(before.is_some_and(|before| before != track.id));
        }
        let n_ignored = self.matches.iter().filter(|m| !objects[m.object].counts);
        sums.n_tracks += (tracks.len() - n_ignored.count()) as u64;
    }

    fn is_near(&self, object: &ScoredPosition, track: &ScoredPosition) -> bool {
        (object.position - track.position).norm() <= self.gate_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GATE_M: f64 = 0.05;

    fn at(id: u64, x: f64) -> ScoredPosition {
        ScoredPosition {
            id,
            position: Point3::new(x, 0.0, 0.0),
            counts: true,
        }
    }

    fn ignored(id: u64, x: f64) -> ScoredPosition {
        ScoredPosition {
            counts: false,
            ..at(id, x)
        }
    }

    fn sums(frames: &[(Vec<ScoredPosition>, Vec<ScoredPosition>)]) -> ClearMot {
        let mut correspondence = Correspondence::new(GATE_M);
        for (objects, tracks) in frames {
            correspondence.step(objects, tracks);
        }
        correspondence.sums()
    }

    proptest! {
        #[test]
        fn perfect_tracks_are_perfect(places in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 3), 1..20)) {
            let frame = |xs: &Vec<f64>| {
                let objects: Vec<_> = xs.iter().zip(1..).map(|(x, id)| at(id, *x)).collect();
                let tracks = objects.iter().map(|o| ScoredPosition { id: o.id + 100, ..*o }).collect();
                (objects, tracks)
            };
            // Objects that meet may be exchanged, so only frames with separated objects are used.
            let apart = |xs: &Vec<f64>| (0..3).all(|i| (i + 1..3).all(|j| (xs[i] - xs[j]).abs() > 2.0 * GATE_M));
            let frames: Vec<_> = places.iter().filter(|xs| apart(xs)).map(frame).collect();
            let sums = sums(&frames);
            prop_assert_eq!(sums.mota().unwrap_or(1.0), 1.0);
            prop_assert_eq!(sums.n_tracks, sums.n_objects);
        }

        #[test]
        fn sums_of_misses_and_matches_agree(
            objects in prop::collection::vec(0.0..0.4_f64, 0..6), tracks in prop::collection::vec(0.0..0.4_f64, 0..6),
        ) {
            let objects: Vec<_> = objects.iter().zip(1..).map(|(x, id)| at(id, *x)).collect();
            let tracks: Vec<_> = tracks.iter().zip(1..).map(|(x, id)| at(id, *x)).collect();
            let mut correspondence = Correspondence::new(GATE_M);
            let n_matches = correspondence.step(&objects, &tracks).len() as u64;
            let sums = correspondence.sums();
            prop_assert_eq!(sums.n_misses + n_matches, objects.len() as u64);
            prop_assert_eq!(sums.n_false_positives + n_matches, tracks.len() as u64);
        }
    }

    #[test]
    fn swapped_tracks_are_two_identity_switches() {
        let before = (vec![at(1, 0.0), at(2, 0.5)], vec![at(7, 0.0), at(8, 0.5)]);
        let after = (vec![at(1, 0.0), at(2, 0.5)], vec![at(8, 0.0), at(7, 0.5)]);
        let frames = [vec![before; 6], vec![after; 4]].concat();
        let sums = sums(&frames);
        assert_eq!(sums.n_switches, 2);
        assert_eq!(sums.mota(), Some(1.0 - 2.0 / 20.0));
    }

    #[test]
    fn previous_match_is_kept_within_the_gate() {
        let mut correspondence = Correspondence::new(GATE_M);
        correspondence.step(&[at(1, 0.0)], &[at(7, 0.0)]);
        let matches = correspondence.step(&[at(1, 0.0)], &[at(8, 0.0), at(7, 0.04)]);
        assert_eq!(
            matches,
            [Match {
                object: 0,
                track: 1
            }]
        );
        assert_eq!(correspondence.sums().n_false_positives, 1);
    }

    #[test]
    fn matching_is_maximal() {
        // Greedy nearest-pair matching would leave the other pair unmatched.
        let objects = [at(1, 0.0), at(2, 0.04)];
        let tracks = [at(7, 0.05), at(8, 0.085)];
        let mut correspondence = Correspondence::new(GATE_M);
        assert_eq!(correspondence.step(&objects, &tracks).len(), 2);
    }

    #[test]
    fn unscored_objects_are_neither_miss_nor_false_positive() {
        let frames = [
            (vec![at(1, 0.0)], vec![at(7, 0.0)]),
            (vec![ignored(1, 0.0)], vec![at(8, 0.0)]),
            (vec![ignored(1, 0.0)], vec![]),
            (vec![at(1, 0.0)], vec![at(8, 0.0)]),
        ];
        let sums = sums(&frames);
        let expected = ClearMot {
            n_objects: 2,
            n_tracks: 2,
            n_switches: 1,
            ..ClearMot::default()
        };
        assert_eq!(sums, expected);
    }
}
