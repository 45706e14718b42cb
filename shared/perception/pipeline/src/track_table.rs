//! The frame loop's half of the step: which candidate is which object.

use crate::departed::Departed;
use crate::frame::{Frame, Measured};
use crate::search::{Search, unseen_place};
use crate::track::{Track, WHOLE_SHARE};
use crate::{Config, Posterior};
use constraint::Truth;
use detection::{Candidate, Detection, ExpectedTrack, Support};
use point_cloud::Point;
use tracking::{
    AssociationBuffers, MotionFilter, Observed, Place, Predicted, Sight, TrackLife, TrackPhase,
    associate, share_inside,
};

/// Where a track that was not seen for a while is looked for: the uncertainty of
/// its place does not grow beyond this, metres. On a table, what is farther away
/// is another object, whose views must not become this one's.
const SEARCH_SIGMA_MAX_M: f64 = 0.04;

/// A fragment of an object has a smaller share of the volume of its box.
const WHOLE_VOLUME_SHARE: f64 = 0.7;

/// Near what was handled so lately, ...
const HANDLED_NS: u64 = 500_000_000;

/// ... nearer to its box than this, metres, nothing new begins: it may be a part of
/// what the hand cuts in two.
const HANDLED_MARGIN_M: f64 = 0.03;

/// What has at most this share of the points of a larger thing, ...
const PART_POINTS_SHARE: f64 = 0.12;

/// ... whose middle is no farther from its box, metres, ...
const PART_REACH_M: f64 = 0.035;

/// ... and whose mean colour is as near, of 255, may be a part of it.
const PART_COLOR_DISTANCE_MAX: f32 = 45.0;

/// A track whose box lies in what another one sees, by this share, ...
const SWALLOWED_SHARE: f64 = 0.8;

/// ... which is at least about as large, ...
const SWALLOWING_RATIO_MIN: f64 = 0.9;

/// ... and which has no candidate of its own in so many frames, has no object.
const N_SWALLOWED_MAX: u32 = 3;

/// A candidate that is a track's object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// The track.
    pub track_id: u64,
    /// The candidate's place in the detection.
    pub candidate: usize,
    /// What it measured.
    pub measured: Measured,
    /// Whether the track begins with it.
    pub is_new: bool,
}

/// What a step has decided. Reused from frame to frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Step {
    /// Tracks with a measurement, known ones first.
    pub sightings: Vec<Sighting>,
    /// Tracks that have ended.
    pub gone: Vec<u64>,
    /// Candidates that continued no track and began none, by their places in the
    /// detection, ascending.
    pub rejected: Vec<usize>,
}

/// The tracks, and what is needed to go on with them.
#[derive(Debug)]
pub struct TrackTable {
    config: Config,
    tracks: Vec<Track>,
    departed: Departed,
    measured: Vec<Option<Measured>>,
    usable: Vec<usize>,
    predicted: Vec<Predicted>,
    observed: Vec<Observed>,
    association: AssociationBuffers,
    rows: Vec<usize>,
    places: Vec<Option<Place>>,
    search: Search,
}

impl TrackTable {
    /// A table without tracks.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            tracks: Vec::new(),
            departed: Departed::default(),
            measured: Vec::new(),
            usable: Vec::new(),
            predicted: Vec::new(),
            observed: Vec::new(),
            association: AssociationBuffers::default(),
            rows: Vec::new(),
            places: Vec::new(),
            search: Search::default(),
        }
    }

    /// The tracks, by track-id.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Ends all tracks, into `gone`, and forgets what has gone before.
    pub fn clear(&mut self, gone: &mut Vec<u64>) {
        gone.extend(self.tracks.drain(..).map(|track| track.id));
        self.departed.clear();
    }

    /// Predicts all tracks to the frame and tells where they are expected, in the
    /// camera's frame. To be asked before detection, which judges by them what is
    /// tracked already, and parts what has come together. A track that was not seen
    /// in the last step gives the box in which it was seen last, too: it may not
    /// have gone where it was going.
    pub fn predict(&mut self, frame: &Frame, expected: &mut Vec<ExpectedTrack>) {
        self.predict_tracks(frame);
        let camera_from_world = frame.world_from_camera.inverse();
        expected.clear();
        for track in &self.tracks {
            expected.push(ExpectedTrack {
                shape: track.box_in_world().transformed(&camera_from_world),
                n_points: track.measured.n_points,
            });
            if track.sight() != Sight::Seen {
                let last_seen = track.posterior.box_in_world();
                expected.push(last_seen.transformed(&camera_from_world).into());
            }
        }
    }

    /// Predicts all tracks to the frame, gives each its candidate, begins tracks
    /// for the candidates left over of which the rule is true, and ends tracks
    /// whose place is empty or which were not seen for too long.
    ///
    /// A track goes on with its candidate whatever the rule says of it, at the
    /// table's rim or held in the air; where a person or the robot is, only with
    /// what looks like its object. `next_id` gives ids in ascending order, `None` while
    /// there are none. `cloud` is that of the detection.
    pub fn step(
        &mut self,
        detection: &Detection,
        cloud: &[Point],
        frame: &Frame,
        mut next_id: impl FnMut() -> Option<u64>,
        step: &mut Step,
    ) {
        step.sightings.clear();
        step.gone.clear();
        step.rejected.clear();
        self.measure(detection, cloud, frame);
        self.predict_tracks(frame);
        self.associate(frame, step);
        self.look_for_unseen(cloud, frame);
        self.end_swallowed();
        self.find_again(frame, step);
        self.miss(frame);
        self.end_lost(frame, step);
        self.begin(detection, frame, &mut next_id, step);
        let Step {
            sightings,
            rejected,
            ..
        } = step;
        let is_sighted = |i: &usize| sightings.iter().any(|sighting| sighting.candidate == *i);
        rejected.extend((0..detection.candidates.len()).filter(|i| !is_sighted(i)));
    }

    /// Takes what an object's half of the step has found. A posterior of a track
    /// that has ended, or older than the track, changes nothing.
    pub fn absorb(&mut self, track_id: u64, posterior: &Posterior) {
        let Ok(i) = self
            .tracks
            .binary_search_by_key(&track_id, |track| track.id)
        else {
            return;
        };
        let track = &mut self.tracks[i];
        if posterior.view_id < track.n_views {
            return;
        }
        let capture_ns = track.filter.stamp_ns();
        track.posterior = posterior.filter;
        track.filter = posterior.filter.predicted(capture_ns, self.config.motion());
        track.n_views = posterior.view_id + 1;
        track.label.clone_from(&posterior.label);
        track.distance = posterior.distance;
        track.probability = posterior.probability;
        track.nearest.clone_from(&posterior.nearest);
        track.n_key_views = posterior.n_key_views;
    }

    fn measure(&mut self, detection: &Detection, cloud: &[Point], frame: &Frame) {
        self.measured.clear();
        for candidate in &detection.candidates {
            let indices = detection.points_of(candidate);
            let measured = candidate
                .is_object_sized
                .then(|| Measured::of(candidate, indices, cloud, frame).ok())
                .flatten();
            self.measured.push(measured);
        }
    }

    fn predict_tracks(&mut self, frame: &Frame) {
        for track in &mut self.tracks {
            // Always from the measured state: predicting a prediction would let
            // a track that is not seen coast for ever.
            track.filter = track
                .posterior
                .predicted(frame.capture_ns, self.config.motion());
        }
    }

    /// Gives each track its candidate; used candidates leave `measured`. First come
    /// the tracks that were seen just now: one that is searched for in a wide place
    /// must not take theirs.
    fn associate(&mut self, frame: &Frame, step: &mut Step) {
        self.places.clear();
        self.places.resize(self.tracks.len(), Some(Place::Unknown));
        for is_sure in [true, false] {
            self.associate_some(is_sure, frame, step);
        }
    }

    fn associate_some(&mut self, is_sure: bool, frame: &Frame, step: &mut Step) {
        self.predicted.clear();
        self.observed.clear();
        self.usable.clear();
        self.rows.clear();
        for (i, track) in self.tracks.iter().enumerate() {
            let was_sure = track.sight() == Sight::Seen && track.phase() == TrackPhase::Confirmed;
            if self.places[i].is_some() && was_sure == is_sure {
                self.rows.push(i);
                self.predicted.push(predicted(track));
            }
        }
        for (i, measured) in self.measured.iter().enumerate() {
            if let Some(measured) = measured {
                self.usable.push(i);
                self.observed.push(measured.observed(&self.config));
            }
        }
        let config = self.config.association();
        let pairs = associate(
            &self.predicted,
            &self.observed,
            config,
            &mut self.association,
        );
        for (row, pair) in self.rows.iter().zip(pairs) {
            let candidate = pair.map(|usable| self.usable[usable]);
            let taken = candidate.and_then(|i| Some((i, self.measured[i].take()?)));
            if let Some((candidate, measured)) = taken {
                see(&mut self.tracks[*row], candidate, &measured, frame, step);
                self.places[*row] = None;
            }
        }
    }

    /// Looks at the places of the tracks without a candidate.
    fn look_for_unseen(&mut self, cloud: &[Point], frame: &Frame) {
        let Some(view) = frame.view(cloud) else {
            return;
        };
        for (track, place) in self.tracks.iter().zip(&mut self.places) {
            if let Some(place) = place {
                *place = unseen_place(track, frame.capture_ns, &view);
            }
        }
    }

    /// Gives tracks whose place is empty the candidates left over that they can
    /// have become since: what a hand takes is faster than any gate.
    fn find_again(&mut self, frame: &Frame, step: &mut Step) {
        let config = self.config.association();
        self.search.pair(
            &self.tracks,
            &self.places,
            &self.measured,
            frame.capture_ns,
            config,
        );
        for (track, place) in self.search.pairs() {
            if let Some(measured) = self.measured[place].take() {
                see(&mut self.tracks[track], place, &measured, frame, step);
                self.places[track] = None;
            }
        }
    }

    /// Two tracks of one object, which was seen in two parts when they began: the
    /// smaller one ends when again and again it lies in what the other one sees.
    fn end_swallowed(&mut self) {
        for i in 0..self.tracks.len() {
            if self.places[i] != Some(Place::Unknown) {
                continue;
            }
            let own = self.tracks[i].box_in_world();
            let is_swallowed = self.tracks.iter().zip(&self.places).any(|(other, place)| {
                let seen = other.measured.measurement.box_in_world();
                place.is_none()
                    && seen.volume_m3() >= own.volume_m3() * SWALLOWING_RATIO_MIN
                    && share_inside(&own, seen) >= SWALLOWED_SHARE
            });
            let track = &mut self.tracks[i];
            track.n_swallowed += u32::from(is_swallowed);
            if track.n_swallowed >= N_SWALLOWED_MAX {
                self.places[i] = Some(Place::Free);
            }
        }
    }

    fn miss(&mut self, frame: &Frame) {
        for (track, place) in self.tracks.iter_mut().zip(&self.places) {
            if let Some(place) = place {
                track.life = track.life.missed(frame.capture_ns, *place);
            }
        }
    }

    fn end_lost(&mut self, frame: &Frame, step: &mut Step) {
        let departed = &mut self.departed;
        self.tracks.retain(|track| {
            let is_lost = track.phase() == TrackPhase::Lost;
            if is_lost {
                step.gone.push(track.id);
                departed.remember(track, frame.capture_ns);
            }
            !is_lost
        });
    }

    fn begin(
        &mut self,
        detection: &Detection,
        frame: &Frame,
        next_id: &mut impl FnMut() -> Option<u64>,
        step: &mut Step,
    ) {
        for (candidate, measured) in self.measured.iter_mut().enumerate() {
            let is_object = detection.candidates[candidate].verdict == Truth::True;
            let Some(measured) = measured.take().filter(|_| is_object) else {
                continue;
            };
            if is_part_of_handled(&self.tracks, &measured, frame)
                || is_part_of_larger(&detection.candidates[candidate], &detection.candidates)
            {
                continue;
            }
            let Some(track_id) = next_id() else { return };
            step.sightings.push(Sighting {
                track_id,
                candidate,
                measured,
                is_new: true,
            });
            let filter = MotionFilter::start(&measured.measurement, self.config.motion());
            self.tracks.push(Track {
                id: track_id,
                first_seen_ns: frame.capture_ns,
                last_seen_ns: frame.capture_ns,
                measured,
                n_views: 0,
                label: None,
                distance: f32::INFINITY,
                probability: None,
                nearest: Default::default(),
                n_key_views: 0,
                linked_to: self.departed.claim(&measured.appearance, frame.capture_ns),
                life: TrackLife::start(frame.capture_ns),
                posterior: filter,
                filter,
                appearance: measured.appearance,
                last_handled_ns: 0,
                n_swallowed: 0,
            });
        }
    }
}

/// Where a track is expected, and what it looks like.
fn predicted(track: &Track) -> Predicted {
    let trace_max_m2 = 3.0 * SEARCH_SIGMA_MAX_M * SEARCH_SIGMA_MAX_M;
    let covariance_m2 = track.filter.position_covariance_m2();
    let share = (trace_max_m2 / covariance_m2.trace()).min(1.0);
    Predicted {
        box_in_world: track.filter.box_in_world(),
        covariance_m2: covariance_m2 * share,
        appearance: track.appearance,
    }
}

/// Whether a candidate may be a part of an object that a hand has just had.
fn is_part_of_handled(tracks: &[Track], measured: &Measured, frame: &Frame) -> bool {
    let centre = measured.measurement.box_in_world().centre();
    tracks.iter().any(|track| {
        track.was_handled(frame.capture_ns, HANDLED_NS)
            && track.box_in_world().contains(&centre, HANDLED_MARGIN_M)
    })
}

/// Whether a candidate is a part of a larger one, like the handle of a mug that the
/// sensor has lost the connection to: small, of the same colour, at its side, and in
/// the air.
fn is_part_of_larger(part: &Candidate, candidates: &[Candidate]) -> bool {
    let is_like = |whole: &Candidate| {
        let pairs = part.mean_rgb.iter().zip(whole.mean_rgb);
        let squares = pairs.map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f32>().sqrt() <= PART_COLOR_DISTANCE_MAX
    };
    let centre = part.oriented_box.centre();
    part.support != Some(Support::Table)
        && candidates.iter().any(|whole| {
            let place = whole.oriented_box.frame_from_box.inverse() * centre;
            let half = whole.oriented_box.half_sides_m;
            part.n_points() as f64 <= PART_POINTS_SHARE * whole.n_points() as f64
                && place.x.abs() <= half.x + PART_REACH_M
                && place.y.abs() <= half.y + PART_REACH_M
                && place.z.abs() <= half.z
                && is_like(whole)
        })
}

/// A track goes on with a candidate.
fn see(track: &mut Track, candidate: usize, measured: &Measured, frame: &Frame, step: &mut Step) {
    track.life = track.life.seen(frame.capture_ns);
    track.last_seen_ns = frame.capture_ns;
    if measured.measurement.seen().is_handled() {
        track.last_handled_ns = frame.capture_ns;
    }
    track.measured = *measured;
    let whole_m3 = WHOLE_VOLUME_SHARE * track.filter.box_in_world().volume_m3();
    let is_whole = !measured.is_cut
        && track.posterior.completeness() >= WHOLE_SHARE
        && measured.appearance.volume_m3 >= whole_m3;
    track.remember(&measured.appearance, is_whole);
    step.sightings.push(Sighting {
        track_id: track.id,
        candidate,
        measured: *measured,
        is_new: false,
    });
}

#[cfg(test)]
mod tests;
