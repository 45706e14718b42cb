//! Tracking metrics of a run: MOTA, IDF1, pose errors, flips, lost tracks.

use crate::clear_mot::{ClearMot, Correspondence, Match, ScoredPosition};
use crate::id_f1::{IdentityCounts, IdentityScore};
use crate::track_wholeness::TrackWholeness;
use crate::tracked_frame::{GroundTruthObject, TrackState, TrackedFrame};
use crate::true_shape::Symmetry;
use std::collections::{BTreeMap, BTreeSet};

/// Gate of the matching: maximum distance of the box centres, metres. Chosen; part of the metric
/// definition.
pub const GATE_M: f64 = 0.05;
/// Minimum jump of a track's orientation relative to its object that counts as a flip, radians.
/// Chosen; part of the metric definition.
const FLIP_RAD: f64 = std::f64::consts::PI / 6.0;
/// Distances from the camera counted as 1 m, metres. Chosen; part of the metric definition.
const ONE_METRE_RANGE_M: std::ops::RangeInclusive<f64> = 0.8..=1.2;

/// Tracking metrics of one run or of several.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackingScore {
    /// CLEAR MOT counts of the tracked sequence.
    pub mot: ClearMot,
    /// Identity score (IDF1) of the tracked sequence.
    pub identity: IdentityScore,
    /// Errors of matched tracks, relative to the box of the surface seen so far.
    pub errors: PoseErrors,
    /// Number of frames in which a published orientation jumped relative to its object.
    pub n_flips: u64,
    /// Number of objects scored in at least one frame.
    pub n_objects: usize,
    /// Number of tracks that were output at least once.
    pub n_tracks: usize,
    /// Number of output tracks never matched with an object, scored or not.
    pub n_tracks_of_nothing: usize,
    /// Number of frames with at least one output track made of a person.
    pub n_frames_with_person_track: u64,
    /// Number of tracks that ended although their object was scored later.
    pub n_lost: usize,
    /// Number of distinct tracks per object, summed over objects.
    pub n_ids: usize,
    /// Tracks of parts, and objects joined in one track.
    pub wholeness: TrackWholeness,
    /// Delay of removal for each removed object, seconds: from the last frame in which it was
    /// visible to the end of its track; `None` if the track never ended.
    pub removed_after_s: Vec<Option<f64>>,
}

/// Pose errors of single frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PoseErrors {
    /// Distance between the box centres, millimetres.
    pub centre_mm: Vec<f64>,
    /// Distance between the box centres for objects 0.8 to 1.2 m away, millimetres.
    pub centre_at_1_m_mm: Vec<f64>,
    /// Horizontal component of the centre error, millimetres.
    pub horizontal_mm: Vec<f64>,
    /// Vertical component of the centre error, positive if the track is too high, millimetres.
    pub vertical_mm: Vec<f64>,
    /// Distance from the centre of the whole object's box, millimetres.
    pub whole_mm: Vec<f64>,
    /// Orientation error relative to the whole object's box, up to its symmetry, degrees.
    pub orientation_deg: Vec<f64>,
    /// Orientation error of objects whose footprint has a direction, degrees.
    pub angular_deg: Vec<f64>,
    /// Orientation error of objects with a direction up to quarter turns, degrees: the error left
    /// if the longer side is not identified.
    pub up_to_quarter_deg: Vec<f64>,
}

impl TrackingScore {
    /// Metrics of the frames of one run in order, and the matches of each frame as indices of its
    /// objects and tracks.
    pub fn of(frames: &[TrackedFrame]) -> (Self, Vec<Vec<Match>>) {
        let mut scorer = TrackingScorer::new();
        let matches: Vec<Vec<Match>> = frames.iter().map(|frame| scorer.step(frame)).collect();
        scorer.finish(frames);
        (scorer.score, matches)
    }

    /// Adds the tracking metrics of another run.
    pub fn add(&mut self, other: &Self) {
        self.mot.add(&other.mot);
        self.identity.add(&other.identity);
        self.errors.add(&other.errors);
        self.n_flips += other.n_flips;
        self.n_objects += other.n_objects;
        self.n_tracks += other.n_tracks;
        self.n_tracks_of_nothing += other.n_tracks_of_nothing;
        self.n_frames_with_person_track += other.n_frames_with_person_track;
        self.n_lost += other.n_lost;
        self.n_ids += other.n_ids;
        self.wholeness.add(&other.wholeness);
        self.removed_after_s.extend(&other.removed_after_s);
    }

    /// Lost tracks per object; `None` without objects.
    pub fn lost(&self) -> Option<f64> {
        (self.n_objects > 0).then(|| self.n_lost as f64 / self.n_objects as f64)
    }
}

impl PoseErrors {
    fn add(&mut self, other: &Self) {
        let Self {
            centre_mm,
            centre_at_1_m_mm,
            horizontal_mm,
            vertical_mm,
            whole_mm,
            orientation_deg,
            angular_deg,
            up_to_quarter_deg,
        } = self;
        centre_mm.extend(&other.centre_mm);
        centre_at_1_m_mm.extend(&other.centre_at_1_m_mm);
        horizontal_mm.extend(&other.horizontal_mm);
        vertical_mm.extend(&other.vertical_mm);
        whole_mm.extend(&other.whole_mm);
        orientation_deg.extend(&other.orientation_deg);
        angular_deg.extend(&other.angular_deg);
        up_to_quarter_deg.extend(&other.up_to_quarter_deg);
    }

    fn take(&mut self, object: &GroundTruthObject, track: &TrackState) {
        let centre = track.box_in_world.centre();
        let Some(seen_box) = &object.seen_box else {
            return;
        };
        let apart = centre - seen_box.centre();
        self.centre_mm.push(1e3 * apart.norm());
        if ONE_METRE_RANGE_M.contains(&object.range_m) {
            self.centre_at_1_m_mm.push(1e3 * apart.norm());
        }
        self.horizontal_mm.push(1e3 * apart.xy().norm());
        self.vertical_mm.push(1e3 * apart.z);
        self.whole_mm
            .push(1e3 * (centre - object.whole_box.centre()).norm());
        let deviation_deg = |symmetry: Symmetry| {
            let found = &track.box_in_world.frame_from_box.rotation;
            let whole = &object.whole_box.frame_from_box.rotation;
            symmetry.deviation_rad(found, whole).to_degrees()
        };
        self.orientation_deg.push(deviation_deg(object.symmetry));
        if object.symmetry != Symmetry::Round {
            self.angular_deg.push(deviation_deg(object.symmetry));
            self.up_to_quarter_deg
                .push(deviation_deg(Symmetry::Quarter));
        }
    }
}

/// Accumulator over the frames of a run.
#[derive(Default)]
struct TrackingScorer {
    score: TrackingScore,
    correspondence: Correspondence,
    identities: IdentityCounts,
    /// Object that each track was last matched with.
    object_of: BTreeMap<u64, u64>,
    /// Matched object-track pairs of the previous frame.
    last_pairs: Vec<(GroundTruthObject, TrackState)>,
    ids_of_object: BTreeMap<u64, BTreeSet<u64>>,
    believed: BTreeSet<u64>,
}

impl TrackingScorer {
    fn new() -> Self {
        Self {
            correspondence: Correspondence::new(GATE_M),
            ..Self::default()
        }
    }

    fn step(&mut self, frame: &TrackedFrame) -> Vec<Match> {
        let outputs: Vec<usize> = (0..frame.tracks.len())
            .filter(|i| frame.tracks[*i].is_output)
            .collect();
        let objects: Vec<ScoredPosition> = frame
            .objects
            .iter()
            .map(GroundTruthObject::scored_position)
            .collect();
        let scored_position = outputs.iter().map(|i| frame.tracks[*i].scored_position());
        let scored_position: Vec<ScoredPosition> = scored_position.collect();
        let matches = self
            .correspondence
            .step(&objects, &scored_position)
            .to_vec();
        self.count_identities(&objects, &scored_position, &matches);
        self.believed
            .extend(scored_position.iter().map(|track| track.id));
        let matches: Vec<Match> = matches
            .into_iter()
            .map(|Match { object, track }| Match {
                object,
                track: outputs[track],
            })
            .collect();
        self.measure(frame, &matches);
        self.score.n_frames_with_person_track += u64::from(!frame.tracks_of_people.is_empty());
        matches
    }

    fn count_identities(
        &mut self,
        objects: &[ScoredPosition],
        tracks: &[ScoredPosition],
        matches: &[Match],
    ) {
        let counted = || objects.iter().filter(|object| object.counts);
        for object in counted() {
            self.identities.add_object(object.id);
            self.ids_of_object.entry(object.id).or_default();
        }
        for (index, track) in tracks.iter().enumerate() {
            let matched = matches.iter().find(|m| m.track == index);
            if matched.is_some_and(|m| !objects[m.object].counts) {
                continue;
            }
            self.identities.add_track(track.id);
            for object in counted() {
                if (object.position - track.position).norm() <= GATE_M {
                    self.identities.add_common_frame(object.id, track.id);
                }
            }
        }
    }

    fn measure(&mut self, frame: &TrackedFrame, matches: &[Match]) {
        let mut pairs = Vec::with_capacity(matches.len());
        for Match { object, track } in matches {
            let (object, track) = (frame.objects[*object], frame.tracks[*track]);
            self.object_of.insert(track.id, object.id);
            let before = self
                .last_pairs
                .iter()
                .find(|(o, t)| o.id == object.id && t.id == track.id);
            let is_flip =
                before.is_some_and(|before| jump_rad(before, &(object, track)) > FLIP_RAD);
            self.score.n_flips += u64::from(is_flip);
            pairs.push((object, track));
            if object.counts {
                self.score.errors.take(&object, &track);
                let ids = self.ids_of_object.entry(object.id).or_default();
                ids.insert(track.id);
            }
        }
        self.last_pairs = pairs;
    }

    fn finish(&mut self, frames: &[TrackedFrame]) {
        let score = &mut self.score;
        score.mot = self.correspondence.sums();
        score.identity = self.identities.score();
        score.n_objects = self.ids_of_object.len();
        score.n_ids = self.ids_of_object.values().map(BTreeSet::len).sum();
        score.n_tracks = self.believed.len();
        let is_of_nothing = |track: &&u64| !self.object_of.contains_key(track);
        score.n_tracks_of_nothing = self.believed.iter().filter(is_of_nothing).count();
        score.wholeness = TrackWholeness::of(frames);
        score.n_lost = n_lost(frames, &self.object_of);
        score.removed_after_s = removed_after_s(frames, &self.object_of);
    }
}

/// Rotation of a track relative to its object between two frames, radians.
fn jump_rad(
    before: &(GroundTruthObject, TrackState),
    after: &(GroundTruthObject, TrackState),
) -> f64 {
    let object_from_box = |(object, track): &(GroundTruthObject, TrackState)| {
        object.world_from_object.rotation.inverse() * track.box_in_world.frame_from_box.rotation
    };
    object_from_box(before).angle_to(&object_from_box(after))
}

/// Number of tracks that ended before the last frame in which their object is scored.
fn n_lost(frames: &[TrackedFrame], object_of: &BTreeMap<u64, u64>) -> usize {
    let mut last_counted: BTreeMap<u64, usize> = BTreeMap::new();
    for (index, frame) in frames.iter().enumerate() {
        let counted = frame.objects.iter().filter(|object| object.counts);
        last_counted.extend(counted.map(|object| (object.id, index)));
    }
    let ended = frames.iter().enumerate().flat_map(|(index, frame)| {
        let ended = frame.ended.iter();
        ended.map(move |track| (index, track))
    });
    ended
        .filter(|(index, track)| {
            let object = object_of.get(track);
            let last = object.and_then(|object| last_counted.get(object));
            last.is_some_and(|last| index < last)
        })
        .count()
}

/// Delays from an object's last visible frame to the end of its tracks, seconds.
fn removed_after_s(frames: &[TrackedFrame], object_of: &BTreeMap<u64, u64>) -> Vec<Option<f64>> {
    let Some(last) = frames.last() else {
        return Vec::new();
    };
    let mut last_visible_s: BTreeMap<u64, f64> = BTreeMap::new();
    for frame in frames {
        let visible = frame.objects.iter().filter(|object| object.is_visible);
        last_visible_s.extend(visible.map(|object| (object.id, frame.time_s)));
    }
    let is_there = |id: u64| last.objects.iter().any(|object| object.id == id);
    let gone = last_visible_s.iter().filter(|(id, _)| !is_there(**id));
    let mut waits_s = Vec::new();
    for (object, visible_s) in gone {
        let tracks = object_of.iter().filter(|(_, of)| *of == object);
        for (track, _) in tracks {
            let end = frames.iter().find(|frame| frame.ended.contains(track));
            match end {
                None => waits_s.push(None),
                Some(end) if end.time_s >= *visible_s => waits_s.push(Some(end.time_s - visible_s)),
                // Tracks that ended earlier were lost before.
                Some(_) => {}
            }
        }
    }
    waits_s
}

#[cfg(test)]
mod tests;
