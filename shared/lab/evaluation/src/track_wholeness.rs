//! Over-segmentation and under-segmentation of tracked objects: tracks of parts, and objects joined
//! in one track.

use crate::tracked_frame::{ObjectPixels, TrackPixels, TrackedFrame};
use std::collections::{BTreeMap, BTreeSet};

/// Share of a track's pixels above which they show one object. Part of the metric definition.
const OF_OBJECT_MIN: f64 = 0.5;

/// Share of an object's visible pixels in a track above which the track contains it. Part of the
/// metric definition.
const CONTAINED_MIN: f64 = 0.5;

/// Time above which a part with a track of its own, or a joined pair, counts, seconds. Part of the
/// metric definition.
const LASTING_S: f64 = 0.5;

/// Numbers of lasting part tracks and of lasting joined pairs of one run or of several.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackWholeness {
    /// Number of tracks that were of a part of an object for more than half a second, beside a
    /// larger track of the same object.
    pub n_part_tracks: usize,
    /// Longest time of a track of a part, seconds.
    pub longest_part_s: f64,
    /// Number of pairs of objects that were in one track for more than half a second.
    pub n_joined_pairs: usize,
    /// Number of pairs of objects that were scored in the same frame at least once.
    pub n_pairs: usize,
}

impl TrackWholeness {
    /// Wholeness of the tracks of one run, from its frames in order.
    pub fn of(frames: &[TrackedFrame]) -> Self {
        let (mut part_s, mut joined_s) = (BTreeMap::new(), BTreeMap::new());
        let mut pairs = BTreeSet::new();
        for (i, frame) in frames.iter().enumerate() {
            let since_s = frame.time_s - frames[i.saturating_sub(1)].time_s;
            for track in part_tracks(&frame.pixels) {
                *part_s.entry(track).or_insert(0.0) += since_s;
            }
            let counted = frame.objects.iter().filter(|object| object.counts);
            let counted: Vec<u64> = counted.map(|object| object.id).collect();
            pairs.extend(pairs_of(&counted));
            for pair in frame.pixels.iter().flat_map(|of| joined(of, &counted)) {
                *joined_s.entry(pair).or_insert(0.0) += since_s;
            }
        }
        let n_lasting = |times: &mut dyn Iterator<Item = &f64>| {
            times.filter(|time_s| **time_s > LASTING_S).count()
        };
        Self {
            n_part_tracks: n_lasting(&mut part_s.values()),
            longest_part_s: part_s.values().copied().fold(0.0, f64::max),
            n_joined_pairs: n_lasting(&mut joined_s.values()),
            n_pairs: pairs.len(),
        }
    }

    /// Adds the numbers of another run.
    pub fn add(&mut self, other: &Self) {
        self.n_part_tracks += other.n_part_tracks;
        self.longest_part_s = self.longest_part_s.max(other.longest_part_s);
        self.n_joined_pairs += other.n_joined_pairs;
        self.n_pairs += other.n_pairs;
    }
}

/// Tracks of a frame whose object has a larger one.
fn part_tracks(tracks: &[TrackPixels]) -> Vec<u64> {
    let mut largest: BTreeMap<u64, &TrackPixels> = BTreeMap::new();
    let mut parts = Vec::new();
    for track in tracks {
        let Some(object) = track.object() else {
            continue;
        };
        match largest.get_mut(&object) {
            None => {
                largest.insert(object, track);
            }
            Some(other) if other.n_pixels < track.n_pixels => {
                parts.push(other.track);
                *other = track;
            }
            Some(_) => parts.push(track.track),
        }
    }
    parts
}

/// Pairs of scored objects that a track contains.
fn joined(track: &TrackPixels, counted: &[u64]) -> Vec<(u64, u64)> {
    let contained = track
        .of_objects
        .iter()
        .filter(|of| of.share_of_object > CONTAINED_MIN && counted.contains(&of.object));
    let contained: Vec<u64> = contained.map(|of| of.object).collect();
    pairs_of(&contained).collect()
}

/// Pairs of objects in a list of them, the smaller number first.
fn pairs_of(objects: &[u64]) -> impl Iterator<Item = (u64, u64)> {
    objects.iter().enumerate().flat_map(move |(i, &a)| {
        let later = objects[i + 1..].iter();
        later.map(move |&b| (a.min(b), a.max(b)))
    })
}

impl TrackPixels {
    /// Object that most of the track's pixels show; `None` where no object is in the majority.
    fn object(&self) -> Option<u64> {
        let is_main =
            |of: &&ObjectPixels| of.n_pixels as f64 > OF_OBJECT_MIN * self.n_pixels as f64;
        self.of_objects.iter().find(is_main).map(|of| of.object)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracked_frame::GroundTruthObject;
    use crate::true_shape::Symmetry;
    use geometry::{OrientedBox, RigidTransform};
    use nalgebra::Vector3;

    fn object(id: u64) -> GroundTruthObject {
        GroundTruthObject {
            id,
            world_from_object: RigidTransform::identity(),
            whole_box: OrientedBox {
                frame_from_box: RigidTransform::identity(),
                half_sides_m: Vector3::repeat(0.05),
            },
            seen_box: None,
            symmetry: Symmetry::Round,
            range_m: 1.0,
            is_visible: true,
            counts: true,
        }
    }

    fn track(track: u64, n_pixels: usize, of_objects: &[(u64, usize, f64)]) -> TrackPixels {
        let of_objects = of_objects.iter();
        TrackPixels {
            track,
            n_pixels,
            of_objects: of_objects
                .map(|&(object, n_pixels, share_of_object)| ObjectPixels {
                    object,
                    n_pixels,
                    share_of_object,
                })
                .collect(),
        }
    }

    /// Wholeness after some frames at 30 Hz with the same tracks.
    fn after(n_frames: u32, tracks: &[TrackPixels]) -> TrackWholeness {
        let frame = |i: u32| TrackedFrame {
            time_s: f64::from(i) / 30.0,
            objects: vec![object(1), object(2), object(3)],
            pixels: tracks.to_vec(),
            ..TrackedFrame::default()
        };
        TrackWholeness::of(&(0..n_frames).map(frame).collect::<Vec<_>>())
    }

    #[test]
    fn the_smaller_track_of_an_object_is_of_a_part_when_it_lasts() {
        let mug = [
            track(7, 60, &[(1, 60, 0.06)]),
            track(8, 900, &[(1, 880, 0.9), (2, 20, 0.02)]),
        ];
        let brief = after(10, &mug);
        assert_eq!((brief.n_part_tracks, brief.n_joined_pairs), (0, 0));
        assert!((brief.longest_part_s - 0.3).abs() < 1e-9);
        let lasting = after(30, &mug);
        assert_eq!((lasting.n_part_tracks, lasting.n_pairs), (1, 3));
    }

    #[test]
    fn two_objects_in_one_track_are_joined_when_it_has_most_of_both() {
        let both = |share: f64| vec![track(7, 900, &[(2, 500, 0.9), (3, 400, share)])];
        assert_eq!(after(30, &both(0.8)).n_joined_pairs, 1);
        assert_eq!(after(30, &both(0.3)).n_joined_pairs, 0);
        assert_eq!(after(10, &both(0.8)).n_joined_pairs, 0);
    }
}
