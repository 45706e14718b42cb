//! Track table: data association and track management, once per frame.

use crate::candidate_measurement::CandidateMeasurement;
use crate::depth_noise_estimate::DepthNoiseEstimate;
use crate::duplicate_tracks::end_duplicates;
use crate::frame_pose::FramePose;
use crate::light_estimate::LightEstimate;
use crate::lost_track_gallery::LostTrackGallery;
use crate::shared_shift::{SharedShift, pose_sigma_m};
use crate::sighting_evidence::sighting_evidence;
use crate::table_height::{OtherTable, TableHeight};
use crate::track::{MOVED_AFTER_HANDLED_NS, Track, WHOLE_FRACTION_MIN};
use crate::track_recovery::{TrackRecovery, occlusion_of_unmatched};
use crate::{Config, Posterior};
use constraint::Ternary;
use detection::{Candidate, Detection, ExpectedTrack, Support, Table};
use geometry::OrientedBox;
use learning::{CategoryIndex, TrackEvidence};
use nalgebra::Vector3;
use point_cloud::Point;
use tracking::{
    AssociationBuffers, DepthView, MotionFilter, OcclusionState, PredictedTrack, TrackLifecycle,
    TrackPhase, Visibility, appearance_cost, associate, fraction_inside,
};

/// Distance between the spheres around two objects within which a hand that moves one may move
/// the other, metres. Chosen.
const MOVED_WITHIN_M: f64 = 0.10;

/// Largest error of the camera pose that is looked for, metres. A larger one would reach from
/// an object to its neighbour. Chosen.
const POSE_ERROR_MAX_M: f64 = 0.10;

/// Upper limit of the predicted position uncertainty in the association gate (standard
/// deviation per axis), metres. A wider gate would reach neighbouring objects and mix
/// their views. Chosen.
const GATE_SIGMA_MAX_M: f64 = 0.04;

/// Volume ratio of measured to predicted box above which a view shows the whole object.
/// Chosen.
const WHOLE_VOLUME_RATIO_MIN: f64 = 0.7;

/// Time after hand contact in which no new track starts near the handled object,
/// nanoseconds. Chosen.
const HANDLED_NS: u64 = 500_000_000;

/// Margin around a recently handled object in which no new track starts, metres: the
/// hand may split the object into parts. Chosen.
const HANDLED_MARGIN_M: f64 = 0.03;

/// Point-count ratio below which a candidate may be a part of a larger one. Chosen.
const PART_POINTS_RATIO_MAX: f64 = 0.12;

/// Largest horizontal distance of a part's centre from the box of the larger candidate,
/// metres. Chosen.
const PART_DISTANCE_MAX_M: f64 = 0.035;

/// Largest Euclidean distance between the mean colours of a part and the larger
/// candidate, per channel 0 to 255. Chosen.
const PART_COLOR_DISTANCE_MAX: f32 = 45.0;

/// Fraction of a candidate inside a visible track's box, or of that box inside the
/// candidate, above which they fill the same space.
const SAME_SPACE_FRACTION_MIN: f64 = 0.5;

/// Fraction of an unseen track's predicted box inside the box of a visible one above which its
/// object would be inside the other: the tolerance of the boxes alone gives up to 0.15. Chosen.
const COLLISION_FRACTION: f64 = 0.3;

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
    /// Measurements of the candidates of the frame that no track has yet.
    measured: Vec<Option<CandidateMeasurement>>,
    association: AssociationBuffers,
    recovery: TrackRecovery,
    shared_shift: SharedShift,
    depth_noise: DepthNoiseEstimate,
    light: LightEstimate,
    other_table: OtherTable,
}

impl TrackTable {
    /// Track table without tracks.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            tracks: Vec::new(),
            lost_tracks: LostTrackGallery::default(),
            measured: Vec::new(),
            association: AssociationBuffers::default(),
            recovery: TrackRecovery::default(),
            shared_shift: SharedShift::default(),
            depth_noise: DepthNoiseEstimate::default(),
            light: LightEstimate::default(),
            other_table: OtherTable::default(),
        }
    }

    /// Live tracks, ascending by track-id.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Replaces the settings, between two frames.
    pub(crate) fn set_config(&mut self, config: Config) {
        self.config = config;
    }

    /// Ratio of the depth noise measured on the table to the configured law, median over the
    /// last frames; `None` before a second with a table.
    pub fn noise_ratio(&self) -> Option<f32> {
        self.depth_noise.ratio()
    }

    /// Ends all tracks, appends their ids to `gone`, empties the lost-track gallery and forgets
    /// the measured noise, the light and the other surfaces.
    pub fn clear(&mut self, gone: &mut Vec<u64>) {
        gone.extend(self.tracks.drain(..).map(|track| track.id));
        self.lost_tracks.clear();
        self.depth_noise = DepthNoiseEstimate::default();
        self.light = LightEstimate::default();
        self.other_table.clear();
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
                colors: Some(track.appearance.colors),
            });
            if track.visibility() != Visibility::Visible {
                let last_seen = track.updated_filter.box_in_world();
                expected.push(ExpectedTrack {
                    oriented_box: last_seen.transformed(&camera_from_world),
                    n_points: 0,
                    colors: Some(track.appearance.colors),
                });
            }
        }
    }

    /// Updates all tracks with a detection: association, recovery, termination of lost tracks
    /// and start of new ones. [`predict`](Self::predict) has predicted them to the frame.
    ///
    /// An existing track accepts its candidate regardless of the constraint rule, for
    /// instance at the table's rim or in the air. In the space of a person or the robot
    /// it accepts only candidates of similar appearance. A new track needs a candidate
    /// for which the rule is true. Of a frame whose table is another than that of the tracks only
    /// the candidates on theirs count; where theirs is not found, no object is said to be gone. `next_id` supplies ascending
    /// ids, or `None` while there are none; `cloud` is the cloud of the detection.
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
        let is_predicted = |track: &Track| track.filter.stamp_ns() == frame.capture_ns;
        debug_assert!(self.tracks.iter().all(is_predicted), "predict comes first");
        let surface = detection.table();
        let surface = surface.map(|table| TableHeight::of(table, frame));
        let is_elsewhere = surface.is_some_and(|surface| {
            !self.is_of_tracks(&surface) && !self.other_table.has_lasted(&surface, frame.capture_ns)
        });
        self.watch_other_table(surface, frame);
        self.measured.clear();
        self.light.add(cloud, frame.capture_ns);
        if !is_elsewhere {
            self.depth_noise.add(detection);
        }
        self.measure(detection, cloud, frame, is_elsewhere);
        let shift_m = self.associate(frame, update);
        for sighting in &mut update.sightings {
            let measurement = &mut sighting.measured.measurement;
            let is_at_rest = !self.may_be_moved(measurement.box_in_world(), detection, frame);
            *measurement = measurement
                .with_pose_sigma_m(pose_sigma_m(&shift_m))
                .with_rest(is_at_rest);
        }
        let view = frame.shifted(&-shift_m).view(cloud, self.depth_noise.law());
        self.classify_unmatched(frame.capture_ns, view.as_ref());
        if is_elsewhere && !self.is_any_of_tracks(detection, frame) {
            self.disregard_free_space();
        }
        end_duplicates(&mut self.tracks);
        self.recover_tracks(frame, update);
        self.mark_missed(frame);
        self.remove_lost_tracks(frame, update);
        self.start_tracks(detection, frame, &mut next_id, update);
        self.remember_tables(detection, frame, update);
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
        let motion = *self.config.motion();
        let Some(track) = self.track_mut(track_id) else {
            return;
        };
        if posterior.view_id < track.n_views {
            return;
        }
        let capture_ns = track.filter.stamp_ns();
        track.updated_filter = posterior.filter;
        track.filter = posterior.filter.predicted(capture_ns, &motion);
        track.n_views = posterior.view_id + 1;
        track.evidence.clone_from(&posterior.evidence);
        track.n_key_views = posterior.n_key_views;
    }

    /// Evidence of a track, for the observation of its next view; empty when it has ended.
    pub fn evidence(&self, track_id: u64) -> TrackEvidence {
        let track = place_of(&self.tracks, track_id).map(|i| &self.tracks[i]);
        track.map_or_else(TrackEvidence::default, |track| track.evidence.clone())
    }

    /// Evidence of the tracks whose labels were read from another state of the taught views, or by
    /// another rule, than the present ones.
    pub fn outdated_evidence(&self, taught: &CategoryIndex) -> Vec<(u64, TrackEvidence)> {
        let rule = self.config.unknown_rule();
        let outdated = self
            .tracks
            .iter()
            .filter(|track| !taught.is_current(&track.evidence, rule));
        outdated
            .map(|track| (track.id, track.evidence.clone()))
            .collect()
    }

    /// Replaces the evidence of a live track by the same evidence read anew.
    pub fn set_evidence(&mut self, track_id: u64, evidence: TrackEvidence) {
        if let Some(track) = self.track_mut(track_id) {
            track.evidence = evidence;
        }
    }

    fn track_mut(&mut self, track_id: u64) -> Option<&mut Track> {
        place_of(&self.tracks, track_id).map(|i| &mut self.tracks[i])
    }

    /// True if something near a box is handled, or was within the last second: a hand moves an
    /// object by another one, too.
    fn may_be_moved(&self, place: &OrientedBox, detection: &Detection, frame: &FramePose) -> bool {
        let is_near = |other: &OrientedBox| place.bounding_spheres_meet(other, MOVED_WITHIN_M);
        let is_handled = |candidate: &Candidate| {
            (candidate.is_touched() || candidate.findings.is_person_or_robot())
                && is_near(&candidate.oriented_box.transformed(&frame.world_from_camera))
        };
        let was_handled = |track: &Track| {
            track.was_handled(frame.capture_ns, MOVED_AFTER_HANDLED_NS)
                && is_near(&track.box_in_world())
        };
        detection.candidates.iter().any(is_handled) || self.tracks.iter().any(was_handled)
    }

    /// True if a surface is the table of a confirmed track, or none of them has one.
    fn is_of_tracks(&self, surface: &TableHeight) -> bool {
        let mut of_tracks = self.confirmed().filter_map(|track| track.table).peekable();
        of_tracks.peek().is_none() || of_tracks.any(|table| table.is_same(surface))
    }

    /// True if one of the surfaces that carry objects is the table of a confirmed track, or none of
    /// them has one.
    fn is_any_of_tracks(&self, detection: &Detection, frame: &FramePose) -> bool {
        let surfaces = detection.surfaces.iter();
        let mut carriers = surfaces.filter(|surface| surface.role.carries_objects());
        carriers.any(|surface| self.is_of_tracks(&TableHeight::of(surface, frame)))
    }

    /// Watches for how long another surface is found in place of the table of the tracks, with
    /// none of them in view.
    fn watch_other_table(&mut self, surface: Option<TableHeight>, frame: &FramePose) {
        let Some(surface) = surface else { return };
        let is_in_view = |track: &Track| track.visibility() == Visibility::Missing;
        if self.is_of_tracks(&surface) || self.confirmed().any(is_in_view) {
            self.other_table.clear();
        } else {
            self.other_table.found(surface, frame.capture_ns);
        }
    }

    fn confirmed(&self) -> impl Iterator<Item = &Track> {
        let tracks = self.tracks.iter();
        tracks.filter(|track| track.phase() == TrackPhase::Confirmed)
    }

    /// Measures the candidates; of a frame of another table only those on a surface of the tracks.
    fn measure(
        &mut self,
        detection: &Detection,
        cloud: &[Point],
        frame: &FramePose,
        is_elsewhere: bool,
    ) {
        let noise = self.depth_noise.law();
        let balance = self.light.white_balance();
        for candidate in &detection.candidates {
            let indices = detection.points_of(candidate);
            let surface = detection.surfaces.get(candidate.surface);
            let is_of_tracks =
                |surface: &Table| self.is_of_tracks(&TableHeight::of(surface, frame));
            let is_measured =
                candidate.is_object_sized && (!is_elsewhere || surface.is_some_and(is_of_tracks));
            let measured = is_measured
                .then(|| {
                    let points = (indices, cloud);
                    CandidateMeasurement::from_candidate(candidate, points, frame, noise, balance)
                        .ok()
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

    /// Predicts all tracks to a frame. Objects do not pass through each other: an unseen one that
    /// would coast into a visible one stays where it was seen.
    fn predict_tracks(&mut self, frame: &FramePose) {
        for i in 0..self.tracks.len() {
            let track = &self.tracks[i];
            // Always predict from the measured state: predictions of predictions would
            // coast without end.
            let known = track.state_to_predict(frame.capture_ns);
            let predict =
                |state: &MotionFilter| state.predicted(frame.capture_ns, self.config.motion());
            let mut filter = predict(&known);
            if track.visibility() != Visibility::Visible && self.collides(i, &filter) {
                filter = predict(&known.stopped());
            }
            self.tracks[i].filter = filter;
        }
    }

    /// True if a track would be inside a visible one at a predicted place.
    fn collides(&self, of: usize, predicted: &MotionFilter) -> bool {
        let place = predicted.box_in_world();
        self.visible_others(of).any(|other| {
            let obstacle = other.updated_filter.box_in_world();
            fraction_inside(&place, &obstacle) > COLLISION_FRACTION
        })
    }

    /// Confirmed, visible tracks other than one.
    fn visible_others(&self, than: usize) -> impl Iterator<Item = &Track> {
        let others = self.tracks.iter().enumerate();
        others.filter_map(move |(i, track)| {
            (i != than && track.is_confirmed_and_visible()).then_some(track)
        })
    }

    /// True if a candidate is a part of another object than that of a track: it is in the box of
    /// one that is seen and looks like it, more than at the place of the track.
    fn is_part_of_another(&self, track: usize, measured: &CandidateMeasurement) -> bool {
        let seen = measured.measurement.box_in_world();
        let at_own_place = fraction_inside(seen, &self.tracks[track].box_in_world());
        let similarity_min = self.config.association().color_similarity_min;
        self.visible_others(track).any(|whole| {
            let colors = &whole.appearance.colors;
            let inside = fraction_inside(seen, &whole.box_in_world());
            inside >= SAME_SPACE_FRACTION_MIN
                && inside > at_own_place
                && colors.similarity(&measured.appearance.colors) >= similarity_min
        })
    }

    /// Assigns candidates to tracks; assigned candidates leave `measured`. Recently seen
    /// tracks come first, so that a track with a wide gate does not take their
    /// candidates. A shift that the assigned ones share is an error of the camera pose: the
    /// others are expected there and assigned again. Returns the shared shift, metres.
    fn associate(&mut self, frame: &FramePose, update: &mut TrackUpdate) -> Vector3<f64> {
        for track in &mut self.tracks {
            track.unmatched = Some(OcclusionState::Unknown);
        }
        self.associate_at(&Vector3::zeros(), frame, update);
        let shift_m = self.shared_shift_m(update);
        if shift_m != Vector3::zeros() {
            self.associate_at(&shift_m, frame, update);
        }
        shift_m
    }

    /// Assigns candidates to the unmatched tracks at their shifted places: to those that were
    /// seen in the previous frame, then to the others.
    fn associate_at(
        &mut self,
        shift_m: &Vector3<f64>,
        frame: &FramePose,
        update: &mut TrackUpdate,
    ) {
        for is_recent in [true, false] {
            let is_expected = |track: &Track| {
                track.unmatched.is_some() && track.is_confirmed_and_visible() == is_recent
            };
            if !self.tracks.iter().any(is_expected) {
                continue;
            }
            let expected = |track| is_expected(track).then(|| predicted(track, shift_m));
            let observed = |measured: &Option<CandidateMeasurement>| {
                Some(measured.as_ref()?.observed_candidate(&self.config))
            };
            let mut buffers = std::mem::take(&mut self.association);
            let candidates = associate(
                self.tracks.iter().map(expected),
                self.measured.iter().map(observed),
                self.config.association(),
                &mut buffers,
            );
            self.continue_tracks(candidates, frame, update);
            self.association = buffers;
        }
    }

    /// Shift that the confirmed objects seen whole share, metres.
    fn shared_shift_m(&mut self, update: &TrackUpdate) -> Vector3<f64> {
        self.shared_shift.clear();
        for sighting in &update.sightings {
            let Some(i) = place_of(&self.tracks, sighting.track_id) else {
                continue;
            };
            let track = &self.tracks[i];
            if track.phase() == TrackPhase::Confirmed && !sighting.measured.is_truncated {
                let measured = sighting.measured.measurement.box_in_world().centre();
                self.shared_shift
                    .add(&(measured - track.box_in_world().centre()));
            }
        }
        for track in &self.tracks {
            if track.unmatched.is_some()
                && track.phase() == TrackPhase::Confirmed
                && let Some(shift_m) = shift_to_alike(track, &self.measured, &self.config)
            {
                self.shared_shift.add(&shift_m);
            }
        }
        self.shared_shift.shift_m()
    }

    /// Occlusion test of the tracks without a candidate.
    fn classify_unmatched(&mut self, capture_ns: u64, view: Option<&DepthView<'_>>) {
        let Some(view) = view else { return };
        for track in self
            .tracks
            .iter_mut()
            .filter(|track| track.unmatched.is_some())
        {
            track.unmatched = Some(occlusion_of_unmatched(track, capture_ns, view));
        }
    }

    /// Takes free space as unknown, in a frame in which the table was not found.
    fn disregard_free_space(&mut self) {
        for track in &mut self.tracks {
            if track.unmatched == Some(OcclusionState::Empty) {
                track.unmatched = Some(OcclusionState::Unknown);
            }
        }
    }

    /// Recovers tracks in free space by matching them with unassigned candidates: a hand
    /// moves objects out of any gate.
    fn recover_tracks(&mut self, frame: &FramePose, update: &mut TrackUpdate) {
        let mut recovery = std::mem::take(&mut self.recovery);
        let config = self.config.association();
        let candidates =
            recovery.match_candidates(&self.tracks, &self.measured, frame.capture_ns, config);
        self.continue_tracks(candidates, frame, update);
        self.recovery = recovery;
    }

    /// Continues each track that has a candidate with it.
    fn continue_tracks(
        &mut self,
        candidates: &[Option<usize>],
        frame: &FramePose,
        update: &mut TrackUpdate,
    ) {
        for (track, candidate) in candidates.iter().enumerate() {
            if let Some(candidate) = *candidate {
                self.continue_track(track, candidate, frame, update);
            }
        }
    }

    /// Continues a track with an unassigned candidate, but not with a part of another object.
    fn continue_track(
        &mut self,
        track: usize,
        candidate: usize,
        frame: &FramePose,
        update: &mut TrackUpdate,
    ) {
        let Some(measured) = self.measured[candidate] else {
            return;
        };
        if self.is_part_of_another(track, &measured) {
            return;
        }
        self.measured[candidate] = None;
        update_track(&mut self.tracks[track], candidate, &measured, frame, update);
    }

    /// Remembers the table of each track that was seen to stand on one.
    fn remember_tables(&mut self, detection: &Detection, frame: &FramePose, update: &TrackUpdate) {
        let standing = update.sightings.iter();
        let standing =
            standing.filter(|seen| seen.measured.measurement.conditions().stands_on_table);
        for sighting in standing {
            let surface = detection.candidates[sighting.candidate].surface;
            let table = detection.surfaces.get(surface);
            if let Some(track) = self.track_mut(sighting.track_id) {
                track.table = table.map(|table| TableHeight::of(table, frame));
            }
        }
    }

    fn mark_missed(&mut self, frame: &FramePose) {
        for track in &mut self.tracks {
            if let Some(occlusion) = track.unmatched {
                track.lifecycle = track.lifecycle.missed(frame.capture_ns, occlusion);
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
                || is_part_of_returning(&self.tracks, &measured, &self.config)
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
                evidence: TrackEvidence::default(),
                n_key_views: 0,
                reidentified_as: self
                    .lost_tracks
                    .reidentify(&measured.appearance, frame.capture_ns),
                lifecycle: TrackLifecycle::start(frame.capture_ns, measured.evidence),
                updated_filter: filter,
                filter,
                appearance: measured.appearance,
                last_handled_ns: 0,
                table: None,
                n_frames_duplicate: 0,
                unmatched: None,
            });
        }
    }
}

/// Place of a live track; `None` when it has ended.
fn place_of(tracks: &[Track], track_id: u64) -> Option<usize> {
    tracks
        .binary_search_by_key(&track_id, |track| track.id)
        .ok()
}

/// Shift of a track to the nearest candidate seen whole that looks like it, metres; `None`
/// without one in reach.
fn shift_to_alike(
    track: &Track,
    measured: &[Option<CandidateMeasurement>],
    config: &Config,
) -> Option<Vector3<f64>> {
    let expected = track.filter.box_in_world().centre();
    let is_alike = |seen: &&CandidateMeasurement| {
        let cost = appearance_cost(&track.appearance, &seen.appearance, config.association());
        !seen.is_truncated && cost.is_some()
    };
    measured
        .iter()
        .flatten()
        .filter(is_alike)
        .map(|seen| seen.measurement.box_in_world().centre() - expected)
        .filter(|shift_m| shift_m.norm() <= POSE_ERROR_MAX_M)
        .min_by(|a, b| a.norm().total_cmp(&b.norm()))
}

/// Predicted track at its shifted place for data association, with a bounded covariance.
fn predicted(track: &Track, shift_m: &Vector3<f64>) -> PredictedTrack {
    let trace_max_m2 = 3.0 * GATE_SIGMA_MAX_M * GATE_SIGMA_MAX_M;
    let covariance_m2 = track.filter.position_covariance_m2();
    let factor = (trace_max_m2 / covariance_m2.trace()).min(1.0);
    let mut box_in_world = track.filter.box_in_world();
    box_in_world.frame_from_box.translation.vector += shift_m;
    PredictedTrack {
        box_in_world,
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

/// True if a candidate that the image border cuts may be the part in view of a kept track that
/// is still out of view. More of it decides: a new track would be a second one of the object.
fn is_part_of_returning(
    tracks: &[Track],
    measured: &CandidateMeasurement,
    config: &Config,
) -> bool {
    let (part, centre) = (
        &measured.appearance,
        measured.measurement.box_in_world().centre(),
    );
    let similarity_min = config.association().color_similarity_min;
    measured.is_truncated_by_image
        && tracks.iter().any(|track| {
            track.phase() == TrackPhase::Confirmed
                && track.visibility() == Visibility::OutOfView
                && track.box_in_world().contains(&centre, POSE_ERROR_MAX_M)
                && track.appearance.colors.similarity(&part.colors) >= similarity_min
        })
}

/// True if a candidate fills the same space as an object that was seen in this frame: it is
/// a fragment of that object, or both are.
fn is_inside_visible(tracks: &[Track], measured: &CandidateMeasurement) -> bool {
    let seen = measured.measurement.box_in_world();
    tracks
        .iter()
        .filter(|track| track.is_confirmed_and_visible())
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
    track.unmatched = None;
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
