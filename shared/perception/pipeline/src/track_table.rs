//! Track table: data association and track management, once per frame.

use crate::candidate_measurement::{CandidateMeasurement, is_handled, observed_candidates};
use crate::depth_noise_estimate::DepthNoiseEstimate;
use crate::duplicate_tracks::end_duplicates;
use crate::frame_pose::FramePose;
use crate::light_estimate::LightEstimate;
use crate::lost_track_gallery::LostTrackGallery;
use crate::scene_motion::SceneMotion;
use crate::shared_shift::{SharedShift, pose_sigma_m};
use crate::sighting_evidence::sighting_evidence;
use crate::table_height::{OtherTable, TableHeight};
use crate::track::{MOVED_AFTER_HANDLED_NS, Track, WHOLE_FRACTION_MIN};
use crate::track_initiation::{SAME_SPACE_FRACTION_MIN, TrackInitiation, may_be_part};
use crate::track_recovery::{TrackRecovery, occlusion_of_unmatched};
use crate::{Config, Posterior};
use constraint::Ternary;
use detection::{Candidate, Detection, ExpectedTrack, Table};
use geometry::OrientedBox;
use learning::{CategoryIndex, TrackEvidence};
use nalgebra::Vector3;
use point_cloud::Point;
use tracking::{
    AssociationBuffers, DepthView, MotionFilter, OcclusionState, PredictedTrack, SightingEvidence,
    Visibility, appearance_cost, associate, fraction_inside,
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
    /// Indices of the candidates that are neither of a track nor of an object that is not yet
    /// certain, ascending.
    pub rejected_candidates: Vec<usize>,
}

/// Live tracks with the buffers of association.
#[derive(Debug)]
pub struct TrackTable {
    config: Config,
    tracks: Vec<Track>,
    lost_tracks: LostTrackGallery,
    initiation: TrackInitiation,
    /// Measurements of the candidates of the frame that no track has yet.
    measured: Vec<Option<CandidateMeasurement>>,
    association: AssociationBuffers,
    recovery: TrackRecovery,
    shared_shift: SharedShift,
    depth_noise: DepthNoiseEstimate,
    light: LightEstimate,
    other_table: OtherTable,
    scene_motion: SceneMotion,
}

impl TrackTable {
    /// Track table without tracks.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            tracks: Vec::new(),
            lost_tracks: LostTrackGallery::default(),
            initiation: TrackInitiation::default(),
            measured: Vec::new(),
            association: AssociationBuffers::default(),
            recovery: TrackRecovery::default(),
            shared_shift: SharedShift::default(),
            depth_noise: DepthNoiseEstimate::default(),
            light: LightEstimate::default(),
            other_table: OtherTable::default(),
            scene_motion: SceneMotion::default(),
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
        self.initiation.clear();
        self.depth_noise = DepthNoiseEstimate::default();
        self.light = LightEstimate::default();
        self.other_table.clear();
        self.scene_motion.clear();
    }

    /// Predicts all tracks to the frame and writes their expected boxes, camera frame,
    /// as a prior for detection. A track not measured in the last frame contributes its
    /// last measured box as well, since its motion may have stopped. Prospective objects
    /// contribute boxes that may be empty.
    pub fn predict(&mut self, frame: &FramePose, expected: &mut Vec<ExpectedTrack>) {
        self.predict_tracks(frame);
        self.initiation
            .predict(frame.capture_ns, self.config.motion());
        let camera_from_world = frame.world_from_camera.inverse();
        expected.clear();
        for track in &self.tracks {
            expected.push(ExpectedTrack {
                oriented_box: track.box_in_world().transformed(&camera_from_world),
                n_points: track.measured.n_points,
                is_handled: track.was_handled(frame.capture_ns, MOVED_AFTER_HANDLED_NS),
                colors: Some(track.appearance.colors),
            });
            if track.visibility() != Visibility::Visible {
                let last_seen = track.updated_filter.box_in_world();
                expected.push(ExpectedTrack {
                    oriented_box: last_seen.transformed(&camera_from_world),
                    n_points: 0,
                    is_handled: false,
                    colors: Some(track.appearance.colors),
                });
            }
        }
        for prospect in self.initiation.prospects() {
            expected.push(ExpectedTrack {
                oriented_box: prospect
                    .filter
                    .box_in_world()
                    .transformed(&camera_from_world),
                // Parts are not kept apart by what may be no object.
                n_points: 0,
                is_handled: false,
                colors: Some(prospect.measured.appearance.colors),
            });
        }
    }

    /// Updates all tracks with a detection: association, recovery, termination of lost tracks
    /// and start of new ones. [`predict`](Self::predict) has predicted them to the frame.
    ///
    /// An existing track accepts its candidate regardless of the constraint rule, for
    /// instance at the table's rim or in the air. In the space of a person or the robot
    /// it accepts only candidates of similar appearance. A new track needs a candidate
    /// for which the rule is true, and starts when an existence test has accepted it. Of a frame
    /// whose table is another than that of the tracks only the candidates on theirs count; where
    /// theirs is not found, no object is said to be gone. `next_id` supplies ascending ids, or
    /// `None` while there are none; `cloud` is the cloud of the detection.
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
            let neighbour = (!is_at_rest).then(|| self.neighbour(sighting.track_id));
            *measurement = measurement
                .with_pose_sigma_m(pose_sigma_m(&shift_m))
                .with_rest(is_at_rest)
                .with_neighbour(neighbour.flatten());
        }
        let view = frame.shifted(&-shift_m).view(cloud, self.depth_noise.law());
        self.classify_unmatched(frame.capture_ns, view.as_ref());
        if is_elsewhere && !self.is_any_of_tracks(detection, frame) {
            self.disregard_free_space();
        }
        let is_another = is_elsewhere || surface.is_none();
        self.scene_motion
            .update(detection, frame, &self.tracks, is_another);
        let prior = self.scene_motion.arrival_prior();
        end_duplicates(&mut self.tracks, prior);
        self.recover_tracks(frame, update);
        self.mark_missed(frame);
        self.remove_lost_tracks(frame, update);
        self.start_tracks(detection, frame, view.as_ref(), &mut next_id, update);
        self.remember_tables(detection, frame, update);
        let TrackUpdate {
            sightings,
            rejected_candidates,
            ..
        } = update;
        let is_matched = |i: usize| sightings.iter().any(|sighting| sighting.candidate == i);
        let is_of_none = |i: &usize| !is_matched(*i) && !self.initiation.has_candidate(*i);
        rejected_candidates.extend((0..detection.candidates.len()).filter(is_of_none));
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
        let is_handled_near = |candidate: &Candidate| {
            is_handled(candidate)
                && is_near(&candidate.oriented_box.transformed(&frame.world_from_camera))
        };
        let was_handled = |track: &Track| {
            track.was_handled(frame.capture_ns, MOVED_AFTER_HANDLED_NS)
                && is_near(&track.box_in_world())
        };
        detection.candidates.iter().any(is_handled_near) || self.tracks.iter().any(was_handled)
    }

    /// Predicted box of the visible object nearest to that of a track, world frame, if both may
    /// touch.
    fn neighbour(&self, track_id: u64) -> Option<OrientedBox> {
        let of = place_of(&self.tracks, track_id)?;
        let own = self.tracks[of].box_in_world();
        let others = self.visible_others(of).map(Track::box_in_world);
        let distance_m = |other: &OrientedBox| (other.centre() - own.centre()).norm();
        others
            .filter(|other| own.bounding_spheres_meet(other, 0.0))
            .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))
    }

    /// True if a surface is the table of a track, or none of them has one.
    fn is_of_tracks(&self, surface: &TableHeight) -> bool {
        let mut of_tracks = self
            .tracks
            .iter()
            .filter_map(|track| track.table)
            .peekable();
        of_tracks.peek().is_none() || of_tracks.any(|table| table.is_same(surface))
    }

    /// True if one of the surfaces that carry objects is the table of a track, or none of
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
        if self.is_of_tracks(&surface) || self.tracks.iter().any(is_in_view) {
            self.other_table.clear();
        } else {
            self.other_table.found(surface, frame.capture_ns);
        }
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

    /// Visible tracks other than one.
    fn visible_others(&self, than: usize) -> impl Iterator<Item = &Track> {
        let others = self.tracks.iter().enumerate();
        others.filter_map(move |(i, track)| (i != than && track.is_visible()).then_some(track))
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
            let is_expected =
                |track: &Track| track.unmatched.is_some() && track.is_visible() == is_recent;
            if !self.tracks.iter().any(is_expected) {
                continue;
            }
            let expected = |track| is_expected(track).then(|| predicted(track, shift_m));
            let mut buffers = std::mem::take(&mut self.association);
            let candidates = associate(
                self.tracks.iter().map(expected),
                observed_candidates(&self.measured, &self.config),
                self.config.association(),
                &mut buffers,
            );
            self.continue_tracks(candidates, frame, update);
            self.association = buffers;
        }
    }

    /// Shift that the objects seen whole share, metres.
    fn shared_shift_m(&mut self, update: &TrackUpdate) -> Vector3<f64> {
        self.shared_shift.clear();
        for sighting in &update.sightings {
            let Some(i) = place_of(&self.tracks, sighting.track_id) else {
                continue;
            };
            let track = &self.tracks[i];
            if !sighting.measured.is_truncated {
                let measured = sighting.measured.measurement.box_in_world().centre();
                self.shared_shift
                    .add(&(measured - track.box_in_world().centre()));
            }
        }
        for track in &self.tracks {
            if track.unmatched.is_some()
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
            let is_lost = track.lifecycle.is_lost();
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

    /// Starts a track with each new object that is certain by now.
    fn start_tracks(
        &mut self,
        detection: &Detection,
        frame: &FramePose,
        view: Option<&DepthView<'_>>,
        next_id: &mut impl FnMut() -> Option<u64>,
        update: &mut TrackUpdate,
    ) {
        let candidates = detection.candidates.as_slice();
        let measured = self.measured.as_mut_slice();
        let known = (self.tracks.as_slice(), frame, &self.config);
        self.initiation.follow(measured, frame, view, &self.config);
        self.initiation
            .start(measured, &self.config, |i, measured| {
                candidates[i].verdict == Ternary::True
                    && measured.evidence != SightingEvidence::Contrary
                    && !may_be_part(measured, known)
            });
        let prior = self.scene_motion.arrival_prior();
        self.initiation.take_certain(prior, |object, candidate| {
            let Some(track_id) = next_id() else {
                return false;
            };
            update.sightings.push(Sighting {
                track_id,
                candidate,
                measured: object.measured,
                is_new: true,
            });
            let looks_like = &object.measured.appearance;
            let lost = self.lost_tracks.reidentify(looks_like, frame.capture_ns);
            self.tracks
                .push(Track::start(track_id, object, lost, frame.capture_ns));
            true
        });
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

/// Continues a track with a candidate.
fn update_track(
    track: &mut Track,
    candidate: usize,
    measured: &CandidateMeasurement,
    frame: &FramePose,
    update: &mut TrackUpdate,
) {
    track.lifecycle = track.lifecycle.observed(frame.capture_ns);
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
