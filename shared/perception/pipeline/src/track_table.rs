//! Track table: data association and track management, once per frame.

use crate::candidate_measurement::CandidateMeasurement;
use crate::duplicate_tracks::end_duplicates;
use crate::frame_pose::FramePose;
use crate::lost_track_gallery::LostTrackGallery;
use crate::shared_shift::SharedShift;
use crate::sighting_evidence::sighting_evidence;
use crate::track::{Track, WHOLE_FRACTION_MIN};
use crate::track_recovery::{TrackRecovery, occlusion_of_unmatched};
use crate::{Config, Posterior};
use constraint::Ternary;
use detection::{Candidate, Detection, ExpectedTrack, Support};
use point_cloud::Point;
use tracking::{
    AssociationBuffers, MotionFilter, ObservedCandidate, OcclusionState, PredictedTrack,
    TrackLifecycle, TrackPhase, Visibility, associate, fraction_inside,
};

/// Upper limit of the predicted position uncertainty in the association gate (standard
/// deviation per axis), metres. A wider gate would reach neighbouring objects and mix
/// their views. Chosen; sensitivity: see `tabula-lab sweep`.
const GATE_SIGMA_MAX_M: f64 = 0.04;

/// Volume ratio of measured to predicted box above which a view shows the whole object.
/// Chosen; sensitivity: see `tabula-lab sweep`.
const WHOLE_VOLUME_RATIO_MIN: f64 = 0.7;

/// Time after hand contact in which no new track starts near the handled object,
/// nanoseconds. Chosen; sensitivity: see `tabula-lab sweep`.
const HANDLED_NS: u64 = 500_000_000;

/// Margin around a recently handled object in which no new track starts, metres: the
/// hand may split the object into parts. Chosen; sensitivity: see `tabula-lab sweep`.
const HANDLED_MARGIN_M: f64 = 0.03;

/// Point-count ratio below which a candidate may be a part of a larger one. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const PART_POINTS_RATIO_MAX: f64 = 0.12;

/// Largest horizontal distance of a part's centre from the box of the larger candidate,
/// metres. Chosen; sensitivity: see `tabula-lab sweep`.
const PART_DISTANCE_MAX_M: f64 = 0.035;

/// Largest Euclidean distance between the mean colours of a part and the larger
/// candidate, per channel 0 to 255. Chosen; sensitivity: see `tabula-lab sweep`.
const PART_COLOR_DISTANCE_MAX: f32 = 45.0;

/// Fraction of a candidate inside a visible track's box, or of that box inside the
/// candidate, above which they fill the same space.
const SAME_SPACE_FRACTION_MIN: f64 = 0.5;

/// Track-to-candidate match of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Track-id of the matched track.
    pub track_id: u64,
    /// Index of the candidate in the detection.
    pub candidate: usize,
    /// Measurement of the matched candidate.
    pub measured: CandidateMeasurement,
    /// `true` when the track starts with this candidate.
    pub is_new: bool,
}

/// Track update of a frame: matches, ended tracks and rejected candidates. Reused from
/// frame to frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackUpdate {
    /// Matched tracks with their measurements; continued tracks precede new ones.
    pub sightings: Vec<Sighting>,
    /// Track-ids of the tracks that ended.
    pub ended_tracks: Vec<u64>,
    /// Indices of the candidates that neither continued nor started a track, ascending.
    pub rejected_candidates: Vec<usize>,
}

/// Live tracks with the buffers of association.
#[derive(Debug)]
pub struct TrackTable {
    config: Config,
    tracks: Vec<Track>,
    lost_tracks: LostTrackGallery,
    measured: Vec<Option<CandidateMeasurement>>,
    candidate_of_column: Vec<usize>,
    predicted: Vec<PredictedTrack>,
    observed: Vec<ObservedCandidate>,
    association: AssociationBuffers,
    track_of_row: Vec<usize>,
    occlusions: Vec<Option<OcclusionState>>,
    recovery: TrackRecovery,
    shared_shift: SharedShift,
}

impl TrackTable {
    /// Track table without tracks.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            tracks: Vec::new(),
            lost_tracks: LostTrackGallery::default(),
            measured: Vec::new(),
            candidate_of_column: Vec::new(),
            predicted: Vec::new(),
            observed: Vec::new(),
            association: AssociationBuffers::default(),
            track_of_row: Vec::new(),
            occlusions: Vec::new(),
            recovery: TrackRecovery::default(),
            shared_shift: SharedShift::default(),
        }
    }

    /// Live tracks, ascending by track-id.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Ends all tracks, appends their ids to `gone` and empties the lost-track gallery.
    pub fn clear(&mut self, gone: &mut Vec<u64>) {
        gone.extend(self.tracks.drain(..).map(|track| track.id));
        self.lost_tracks.clear();
    }

    /// Predicts all tracks to the frame and writes their expected boxes, camera frame,
    /// as a prior for detection. A track not measured in the last frame contributes its
    /// last measured box as well, since its motion may have stopped.
    pub fn predict(&mut self, frame: &FramePose, expected: &mut Vec<ExpectedTrack>) {
        self.predict_tracks(frame);
        let camera_from_world = frame.world_from_camera.inverse();
        expected.clear();
        for track in &self.tracks {
            expected.push(ExpectedTrack {
                oriented_box: track.box_in_world().transformed(&camera_from_world),
                n_points: track.measured.n_points,
            });
            if track.visibility() != Visibility::Visible {
                let last_seen = track.updated_filter.box_in_world();
                expected.push(last_seen.transformed(&camera_from_world).into());
            }
        }
    }

    /// Updates all tracks with a detection: prediction, association, recovery,
    /// termination of lost tracks and start of new ones.
    ///
    /// An existing track accepts its candidate regardless of the constraint rule, for
    /// instance at the table's rim or in the air. In the space of a person or the robot
    /// it accepts only candidates of similar appearance. A new track needs a candidate
    /// for which the rule is true. `next_id` supplies ascending ids, or `None` while
    /// there are none; `cloud` is the cloud of the detection.
    pub fn update(
        &mut self,
        detection: &Detection,
        cloud: &[Point],
        frame: &FramePose,
        mut next_id: impl FnMut() -> Option<u64>,
        update: &mut TrackUpdate,
    ) {
        update.sightings.clear();
        update.ended_tracks.clear();
        update.rejected_candidates.clear();
        self.measure(detection, cloud, frame);
        self.predict_tracks(frame);
        self.associate(frame, update);
        self.attribute_shared_shift(update);
        self.classify_unmatched(cloud, frame);
        end_duplicates(&mut self.tracks, &mut self.occlusions);
        self.recover_tracks(frame, update);
        self.mark_missed(frame);
        self.remove_lost_tracks(frame, update);
        self.start_tracks(detection, frame, &mut next_id, update);
        let TrackUpdate {
            sightings,
            rejected_candidates,
            ..
        } = update;
        let is_matched = |i: &usize| sightings.iter().any(|sighting| sighting.candidate == *i);
        rejected_candidates.extend((0..detection.candidates.len()).filter(|i| !is_matched(i)));
    }

    /// Applies an object's posterior to its track. A posterior of an ended track, or one
    /// older than the track, is ignored.
    pub fn apply_posterior(&mut self, track_id: u64, posterior: &Posterior) {
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
        track.updated_filter = posterior.filter;
        track.filter = posterior.filter.predicted(capture_ns, self.config.motion());
        track.n_views = posterior.view_id + 1;
        track.label.clone_from(&posterior.label);
        track.distance = posterior.distance;
        track.probability = posterior.probability;
        track.nearest.clone_from(&posterior.nearest);
        track.n_key_views = posterior.n_key_views;
    }

    fn measure(&mut self, detection: &Detection, cloud: &[Point], frame: &FramePose) {
        self.measured.clear();
        for candidate in &detection.candidates {
            let indices = detection.points_of(candidate);
            let measured = candidate
                .is_object_sized
                .then(|| {
                    CandidateMeasurement::from_candidate(candidate, indices, cloud, frame).ok()
                })
                .flatten();
            let evidence = sighting_evidence(candidate, &detection.candidates);
            self.measured
                .push(measured.map(|measured| CandidateMeasurement {
                    evidence,
                    ..measured
                }));
        }
    }

    fn predict_tracks(&mut self, frame: &FramePose) {
        for track in &mut self.tracks {
            // Always predict from the measured state: predictions of predictions would
            // coast without end.
            let known = track.state_to_predict(frame.capture_ns);
            track.filter = known.predicted(frame.capture_ns, self.config.motion());
        }
    }

    /// Assigns candidates to tracks; assigned candidates leave `measured`. Recently seen
    /// tracks come first, so that a track with a wide gate does not take their
    /// candidates.
    fn associate(&mut self, frame: &FramePose, update: &mut TrackUpdate) {
        self.occlusions.clear();
        self.occlusions
            .resize(self.tracks.len(), Some(OcclusionState::Unknown));
        for is_recent in [true, false] {
            self.associate_subset(is_recent, frame, update);
        }
    }

    fn associate_subset(&mut self, is_recent: bool, frame: &FramePose, update: &mut TrackUpdate) {
        self.predicted.clear();
        self.observed.clear();
        self.candidate_of_column.clear();
        self.track_of_row.clear();
        for (i, track) in self.tracks.iter().enumerate() {
            let was_recent =
                track.visibility() == Visibility::Visible && track.phase() == TrackPhase::Confirmed;
            if self.occlusions[i].is_some() && was_recent == is_recent {
                self.track_of_row.push(i);
                self.predicted.push(predicted(track));
            }
        }
        for (i, measured) in self.measured.iter().enumerate() {
            if let Some(measured) = measured {
                self.candidate_of_column.push(i);
                self.observed
                    .push(measured.observed_candidate(&self.config));
            }
        }
        let config = self.config.association();
        let pairs = associate(
            &self.predicted,
            &self.observed,
            config,
            &mut self.association,
        );
        for (row, pair) in self.track_of_row.iter().zip(pairs) {
            let candidate =
                pair.map(|candidate_of_column| self.candidate_of_column[candidate_of_column]);
            let taken = candidate.and_then(|i| Some((i, self.measured[i].take()?)));
            if let Some((candidate, measured)) = taken {
                update_track(&mut self.tracks[*row], candidate, &measured, frame, update);
                self.occlusions[*row] = None;
            }
        }
    }

    /// Attributes the shift that the untouched objects share to the camera pose, as noise of
    /// their measurements.
    fn attribute_shared_shift(&mut self, update: &mut TrackUpdate) {
        self.shared_shift.clear();
        let sighted = |tracks: &[Track], sighting: &Sighting| {
            let found = tracks.binary_search_by_key(&sighting.track_id, |track| track.id);
            found.ok()
        };
        for sighting in &update.sightings {
            let Some(track) = sighted(&self.tracks, sighting).map(|i| &self.tracks[i]) else {
                continue;
            };
            if track.phase() == TrackPhase::Confirmed && !sighting.measured.is_truncated {
                let measured = sighting.measured.measurement.box_in_world().centre();
                self.shared_shift
                    .add(&(measured - track.box_in_world().centre()));
            }
        }
        let pose_sigma_m = self.shared_shift.pose_sigma_m();
        for sighting in &mut update.sightings {
            let measurement = &mut sighting.measured.measurement;
            *measurement = measurement.with_pose_sigma_m(pose_sigma_m);
        }
    }

    /// Occlusion test of the tracks without a candidate.
    fn classify_unmatched(&mut self, cloud: &[Point], frame: &FramePose) {
        let Some(view) = frame.view(cloud) else {
            return;
        };
        for (track, occlusion) in self.tracks.iter().zip(&mut self.occlusions) {
            if let Some(occlusion) = occlusion {
                *occlusion = occlusion_of_unmatched(track, frame.capture_ns, &view);
            }
        }
    }

    /// Recovers tracks in free space by matching them with unassigned candidates: a hand
    /// moves objects out of any gate.
    fn recover_tracks(&mut self, frame: &FramePose, update: &mut TrackUpdate) {
        let config = self.config.association();
        self.recovery.match_candidates(
            &self.tracks,
            &self.occlusions,
            &self.measured,
            frame.capture_ns,
            config,
        );
        for (track, candidate) in self.recovery.pairs() {
            if let Some(measured) = self.measured[candidate].take() {
                update_track(&mut self.tracks[track], candidate, &measured, frame, update);
                self.occlusions[track] = None;
            }
        }
    }

    fn mark_missed(&mut self, frame: &FramePose) {
        for (track, occlusion) in self.tracks.iter_mut().zip(&self.occlusions) {
            if let Some(occlusion) = occlusion {
                track.lifecycle = track.lifecycle.missed(frame.capture_ns, *occlusion);
            }
        }
    }

    fn remove_lost_tracks(&mut self, frame: &FramePose, update: &mut TrackUpdate) {
        let lost_tracks = &mut self.lost_tracks;
        self.tracks.retain(|track| {
            let is_lost = track.phase() == TrackPhase::Lost;
            if is_lost {
                update.ended_tracks.push(track.id);
                lost_tracks.insert(track, frame.capture_ns);
            }
            !is_lost
        });
        let TrackUpdate {
            sightings,
            ended_tracks,
            ..
        } = update;
        sightings.retain(|sighting| !ended_tracks.contains(&sighting.track_id));
    }

    fn start_tracks(
        &mut self,
        detection: &Detection,
        frame: &FramePose,
        next_id: &mut impl FnMut() -> Option<u64>,
        update: &mut TrackUpdate,
    ) {
        for (candidate, measured) in self.measured.iter_mut().enumerate() {
            let is_object = detection.candidates[candidate].verdict == Ternary::True;
            let Some(measured) = measured.take().filter(|_| is_object) else {
                continue;
            };
            if is_part_of_handled(&self.tracks, &measured, frame)
                || is_inside_visible(&self.tracks, &measured)
                || is_part_of_larger(&detection.candidates[candidate], &detection.candidates)
            {
                continue;
            }
            let Some(track_id) = next_id() else { return };
            update.sightings.push(Sighting {
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
                reidentified_as: self
                    .lost_tracks
                    .reidentify(&measured.appearance, frame.capture_ns),
                lifecycle: TrackLifecycle::start(frame.capture_ns, measured.evidence),
                updated_filter: filter,
                filter,
                appearance: measured.appearance,
                last_handled_ns: 0,
                n_frames_duplicate: 0,
            });
        }
    }
}

/// Predicted track for data association, with a bounded covariance.
fn predicted(track: &Track) -> PredictedTrack {
    let trace_max_m2 = 3.0 * GATE_SIGMA_MAX_M * GATE_SIGMA_MAX_M;
    let covariance_m2 = track.filter.position_covariance_m2();
    let factor = (trace_max_m2 / covariance_m2.trace()).min(1.0);
    PredictedTrack {
        box_in_world: track.filter.box_in_world(),
        covariance_m2: covariance_m2 * factor,
        appearance: track.appearance,
    }
}

/// True if a candidate may be a part of a recently handled object.
fn is_part_of_handled(
    tracks: &[Track],
    measured: &CandidateMeasurement,
    frame: &FramePose,
) -> bool {
    let centre = measured.measurement.box_in_world().centre();
    tracks.iter().any(|track| {
        track.was_handled(frame.capture_ns, HANDLED_NS)
            && track.box_in_world().contains(&centre, HANDLED_MARGIN_M)
    })
}

/// True if a candidate fills the same space as an object that was seen in this frame: it is
/// a fragment of that object, or both are.
fn is_inside_visible(tracks: &[Track], measured: &CandidateMeasurement) -> bool {
    let seen = measured.measurement.box_in_world();
    tracks
        .iter()
        .filter(|track| track.phase() == TrackPhase::Confirmed)
        .filter(|track| track.visibility() == Visibility::Visible)
        .any(|track| {
            let known = track.box_in_world();
            fraction_inside(seen, &known) >= SAME_SPACE_FRACTION_MIN
                || fraction_inside(&known, seen) >= SAME_SPACE_FRACTION_MIN
        })
}

/// True if a candidate is probably a detached part of a larger one, such as a mug's
/// handle without depth at its joint: few points, similar colour, close, and not
/// supported by the table.
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
            part.n_points() as f64 <= PART_POINTS_RATIO_MAX * whole.n_points() as f64
                && place.x.abs() <= half.x + PART_DISTANCE_MAX_M
                && place.y.abs() <= half.y + PART_DISTANCE_MAX_M
                && place.z.abs() <= half.z
                && is_like(whole)
        })
}

/// Continues a track with a candidate.
fn update_track(
    track: &mut Track,
    candidate: usize,
    measured: &CandidateMeasurement,
    frame: &FramePose,
    update: &mut TrackUpdate,
) {
    track.lifecycle = track
        .lifecycle
        .observed(frame.capture_ns, measured.evidence);
    track.last_seen_ns = frame.capture_ns;
    if measured.measurement.conditions().is_handled() {
        track.last_handled_ns = frame.capture_ns;
    }
    track.measured = *measured;
    let whole_m3 = WHOLE_VOLUME_RATIO_MIN * track.filter.box_in_world().volume_m3();
    let is_whole = !measured.is_truncated
        && track.updated_filter.completeness() >= WHOLE_FRACTION_MIN
        && measured.appearance.volume_m3 >= whole_m3;
    track.remember(&measured.appearance, is_whole);
    update.sightings.push(Sighting {
        track_id: track.id,
        candidate,
        measured: *measured,
        is_new: false,
    });
}

#[cfg(test)]
mod tests;
