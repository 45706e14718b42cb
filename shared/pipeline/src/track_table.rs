//! The frame loop's half of the step: which candidate is which object.

use crate::frame::{Frame, Measured};
use crate::{Config, Posterior};
use detection::{Detection, Truth};
use geometry::OrientedBox;
use learning::CategoryName;
use tracking::{
    Appearance, AssociationBuffers, MotionFilter, Observed, Place, Predicted, TrackLife,
    TrackPhase, associate,
};

/// Where a track that was not seen for a while is looked for: the uncertainty of
/// its place does not grow beyond this, metres. On a table, what is farther away
/// is another object, whose views must not become this one's.
const SEARCH_SIGMA_MAX_M: f64 = 0.04;

/// One object as the frame loop knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The track-id.
    pub id: u64,
    /// Capture stamp of the first sighting.
    pub first_seen_ns: u64,
    /// Capture stamp of the last sighting.
    pub last_seen_ns: u64,
    /// Whether it was sighted in the last frame.
    pub is_seen: bool,
    /// What the last sighting measured.
    pub measured: Measured,
    /// Views described.
    pub n_views: u32,
    /// The learned category; `None` when unknown.
    pub label: Option<CategoryName>,
    /// Distance to the nearest stored view; infinite when nothing was taught.
    pub distance: f32,
    life: TrackLife,
    /// After the last measurement.
    posterior: MotionFilter,
    /// The same, predicted to the last step.
    filter: MotionFilter,
    appearance: Appearance,
}

impl Track {
    /// How far the track is to be believed.
    pub fn phase(&self) -> TrackPhase {
        self.life.phase()
    }

    /// The box at the last step's capture stamp, world frame.
    pub fn box_in_world(&self) -> OrientedBox {
        self.filter.box_in_world()
    }
}

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
    measured: Vec<Option<Measured>>,
    usable: Vec<usize>,
    predicted: Vec<Predicted>,
    observed: Vec<Observed>,
    association: AssociationBuffers,
}

impl TrackTable {
    /// A table without tracks.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            tracks: Vec::new(),
            measured: Vec::new(),
            usable: Vec::new(),
            predicted: Vec::new(),
            observed: Vec::new(),
            association: AssociationBuffers::default(),
        }
    }

    /// The tracks, by track-id.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Ends all tracks, into `gone`.
    pub fn clear(&mut self, gone: &mut Vec<u64>) {
        gone.extend(self.tracks.drain(..).map(|track| track.id));
    }

    /// Predicts all tracks to the frame and gives their boxes, in the camera's
    /// frame. To be asked before detection, which judges by them what is tracked
    /// already. A track that was not seen in the last step gives the box in which
    /// it was seen last, too: it may not have gone where it was going.
    pub fn predict(&mut self, frame: &Frame, boxes_in_camera: &mut Vec<OrientedBox>) {
        self.predict_tracks(frame);
        let camera_from_world = frame.world_from_camera.inverse();
        boxes_in_camera.clear();
        for track in &self.tracks {
            let last_seen = (!track.is_seen).then(|| track.posterior.box_in_world());
            let boxes = [Some(track.box_in_world()), last_seen];
            let in_camera = boxes
                .into_iter()
                .flatten()
                .map(|in_world| in_world.transformed(&camera_from_world));
            boxes_in_camera.extend(in_camera);
        }
    }

    /// Predicts all tracks to the frame, gives each its candidate, begins tracks
    /// for the candidates left over of which the rule is true, and ends tracks
    /// not seen for too long.
    ///
    /// A track goes on with its candidate whatever the rule says of it, at the
    /// table's rim or held in the air, but never with a part of a person or of
    /// the robot. `next_id` gives ids in ascending order, `None` while there are
    /// none.
    pub fn step(
        &mut self,
        detection: &Detection,
        frame: &Frame,
        mut next_id: impl FnMut() -> Option<u64>,
        step: &mut Step,
    ) {
        step.sightings.clear();
        step.gone.clear();
        step.rejected.clear();
        self.measure(detection, frame);
        self.predict_tracks(frame);
        self.associate(frame, step);
        self.end_lost(step);
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
    }

    fn measure(&mut self, detection: &Detection, frame: &Frame) {
        self.measured.clear();
        self.usable.clear();
        self.observed.clear();
        for (i, candidate) in detection.candidates.iter().enumerate() {
            let measured = candidate
                .can_continue_track()
                .then(|| Measured::of(candidate, frame).ok())
                .flatten();
            if let Some(measured) = &measured {
                self.usable.push(i);
                self.observed
                    .push(measured.observed(candidate, frame, &self.config));
            }
            self.measured.push(measured);
        }
    }

    fn predict_tracks(&mut self, frame: &Frame) {
        self.predicted.clear();
        for track in &mut self.tracks {
            // Always from the measured state: predicting a prediction would let
            // a track that is not seen coast for ever.
            track.filter = track
                .posterior
                .predicted(frame.capture_ns, self.config.motion());
            let variance_m2 = track.filter.position_variance_m2();
            self.predicted.push(Predicted {
                position: track.filter.box_in_world().centre(),
                position_variance_m2: variance_m2.min(SEARCH_SIGMA_MAX_M * SEARCH_SIGMA_MAX_M),
                appearance: track.appearance,
            });
        }
    }

    /// Gives each track its candidate; used candidates leave `measured`.
    fn associate(&mut self, frame: &Frame, step: &mut Step) {
        let config = self.config.association();
        let pairs = associate(
            &self.predicted,
            &self.observed,
            config,
            &mut self.association,
        );
        for (track, pair) in self.tracks.iter_mut().zip(pairs) {
            let candidate = pair.map(|usable| self.usable[usable]);
            let taken = candidate.and_then(|i| Some((i, self.measured[i].take()?)));
            track.is_seen = taken.is_some();
            let Some((candidate, measured)) = taken else {
                track.life = track.life.missed(frame.capture_ns, Place::Unknown);
                continue;
            };
            track.life = track.life.seen(frame.capture_ns);
            track.last_seen_ns = frame.capture_ns;
            track.measured = measured;
            // A cut view says nothing of the size; it is remembered from a whole one.
            if !measured.is_cut || track.appearance.is_cut {
                track.appearance = measured.appearance;
            }
            let sighting = Sighting {
                track_id: track.id,
                candidate,
                measured,
                is_new: false,
            };
            step.sightings.push(sighting);
        }
    }

    fn end_lost(&mut self, step: &mut Step) {
        self.tracks.retain(|track| {
            let is_lost = track.phase() == TrackPhase::Lost;
            if is_lost {
                step.gone.push(track.id);
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
                is_seen: true,
                measured,
                n_views: 0,
                label: None,
                distance: f32::INFINITY,
                life: TrackLife::start(frame.capture_ns),
                posterior: filter,
                filter,
                appearance: measured.appearance,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use detection::{Candidate, Constraint, ConstraintSet, Finding, Findings, Reason, Support};
    use geometry::RigidTransform;
    use nalgebra::{Point3, Vector3};
    use tracking::{AssociationConfig, MotionConfig};

    const FRAME_NS: u64 = 33_333_333;

    fn candidate_at(x: f64) -> Candidate {
        let frame_from_box = RigidTransform::new(Vector3::new(x, 0.0, 0.8), Vector3::zeros());
        Candidate {
            range: 0..100,
            centroid: Point3::new(x, 0.0, 0.8),
            oriented_box: OrientedBox {
                frame_from_box,
                half_sides_m: Vector3::repeat(0.05),
            },
            mean_rgb: [120.0; 3],
            support: Some(Support::Table),
            touches_image_border: false,
            is_object_sized: true,
            findings: Findings::default(),
            verdict: Truth::True,
            decisive: ConstraintSet::NONE,
        }
    }

    /// The same, of which the rule is not true.
    fn ignored_at(x: f64, verdict: Truth) -> Candidate {
        Candidate {
            verdict,
            support: None,
            ..candidate_at(x)
        }
    }

    /// The same as a part of the robot or of a person.
    fn limb_at(x: f64, constraint: Constraint) -> Candidate {
        let mut limb = ignored_at(x, Truth::False);
        let reason = Reason::NotJudged;
        let truth = Truth::True;
        limb.findings.set(constraint, Finding { truth, reason });
        limb
    }

    /// A table and the steps it makes, with ids counted from 1.
    struct Story {
        table: TrackTable,
        step: Step,
        n_frames: u64,
        last_id: u64,
    }

    impl Story {
        fn new() -> Self {
            let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
            let config = Config::new(motion, association, 0.75).unwrap();
            Self {
                table: TrackTable::new(config),
                step: Step::default(),
                n_frames: 0,
                last_id: 0,
            }
        }

        /// One frame with an object at each place.
        fn frame(&mut self, places: &[f64]) {
            self.frame_of(places.iter().map(|x| candidate_at(*x)).collect());
        }

        fn frame_of(&mut self, candidates: Vec<Candidate>) {
            let detection = Detection {
                candidates,
                ..Detection::default()
            };
            let frame = Frame {
                capture_ns: self.n_frames * FRAME_NS,
                world_from_camera: RigidTransform::identity(),
            };
            self.n_frames += 1;
            let last_id = &mut self.last_id;
            let next_id = || {
                *last_id += 1;
                Some(*last_id)
            };
            self.table.step(&detection, &frame, next_id, &mut self.step);
        }

        fn ids(&self) -> Vec<u64> {
            self.table.tracks().iter().map(|track| track.id).collect()
        }
    }

    #[test]
    fn objects_keep_their_ids_and_new_ones_get_the_next() {
        let mut story = Story::new();
        for _ in 0..10 {
            story.frame(&[0.0, 0.3]);
        }
        assert_eq!(story.ids(), [1, 2]);
        story.frame(&[0.3, 0.6, 0.0]);
        assert_eq!(story.ids(), [1, 2, 3]);
        let new = story
            .step
            .sightings
            .iter()
            .filter(|sighting| sighting.is_new);
        assert_eq!(
            new.map(|sighting| sighting.track_id).collect::<Vec<_>>(),
            [3]
        );
    }

    #[test]
    fn an_unseen_track_stays_near_where_it_was_and_ends_in_time() {
        let mut story = Story::new();
        for _ in 0..10 {
            story.frame(&[0.0]);
        }
        for _ in 0..40 {
            story.frame(&[]);
            let place = story.table.tracks()[0].box_in_world().centre();
            assert!(place.x.abs() < 0.05, "{place}");
        }
        for _ in 0..10 {
            story.frame(&[]);
        }
        assert_eq!(story.ids(), [0_u64; 0]);
    }

    #[test]
    fn without_ids_nothing_begins_and_clearing_ends_all() {
        let mut story = Story::new();
        story.frame(&[0.0]);
        let mut gone = Vec::new();
        story.table.clear(&mut gone);
        assert_eq!((gone, story.ids()), (vec![1], vec![]));
        let detection = Detection {
            candidates: vec![candidate_at(0.0)],
            ..Detection::default()
        };
        let frame = Frame {
            capture_ns: 1,
            world_from_camera: RigidTransform::identity(),
        };
        story
            .table
            .step(&detection, &frame, || None, &mut story.step);
        assert_eq!((story.ids(), &story.step.rejected), (vec![], &vec![0]));
    }

    #[test]
    fn only_what_the_rule_is_true_of_begins_a_track() {
        let mut story = Story::new();
        story.frame_of(vec![
            ignored_at(0.0, Truth::False),
            candidate_at(0.3),
            ignored_at(0.6, Truth::Unknown),
        ]);
        assert_eq!(story.ids(), [1]);
        assert_eq!(story.step.sightings[0].candidate, 1);
        assert_eq!(story.step.rejected, [0, 2]);
    }

    #[test]
    fn a_track_goes_on_whatever_the_rule_says() {
        for verdict in [Truth::False, Truth::Unknown] {
            let mut story = Story::new();
            story.frame(&[0.0]);
            for _ in 0..60 {
                story.frame_of(vec![ignored_at(0.0, verdict)]);
                assert!(story.table.tracks()[0].is_seen);
            }
            assert_eq!((story.ids(), story.step.rejected.len()), (vec![1], 0));
        }
    }

    #[test]
    fn a_track_never_goes_on_with_a_hand_or_the_arm() {
        for constraint in [Constraint::Robot, Constraint::Instructor] {
            let mut story = Story::new();
            story.frame(&[0.0]);
            story.frame_of(vec![limb_at(0.0, constraint)]);
            assert!(!story.table.tracks()[0].is_seen);
            assert_eq!(story.step.rejected, [0]);
            let oversized = Candidate {
                is_object_sized: false,
                ..candidate_at(0.0)
            };
            story.frame_of(vec![oversized]);
            assert!(!story.table.tracks()[0].is_seen);
            assert_eq!(story.ids(), [1]);
        }
    }

    #[test]
    fn what_is_left_of_an_object_in_a_hand_does_not_shrink_its_track() {
        let mut story = Story::new();
        for _ in 0..20 {
            story.frame(&[0.0]);
        }
        let mut touched = ignored_at(0.0, Truth::Unknown);
        touched.oriented_box.half_sides_m.z = 0.02;
        let truth = Truth::Unknown;
        let reason = Reason::NotJudged;
        touched
            .findings
            .set(Constraint::Instructor, Finding { truth, reason });
        for _ in 0..20 {
            story.frame_of(vec![touched.clone()]);
        }
        let track = &story.table.tracks()[0];
        assert!(track.is_seen && track.measured.is_cut && !track.measured.is_cut_by_image);
        assert!(
            track.appearance.volume_m3 > 0.9e-3,
            "{:?}",
            track.appearance
        );
    }

    #[test]
    fn the_boxes_of_the_tracks_are_known_before_detection() {
        let mut story = Story::new();
        story.frame(&[0.0, 0.3]);
        let world_from_camera =
            RigidTransform::new(Vector3::new(0.5, -0.2, 1.0), Vector3::new(2.0, 0.1, 0.0));
        let frame = Frame {
            capture_ns: FRAME_NS,
            world_from_camera,
        };
        let mut boxes = vec![];
        story.table.predict(&frame, &mut boxes);
        assert_eq!(boxes.len(), 2);
        for (found, x) in boxes.iter().zip([0.0, 0.3]) {
            let in_world = world_from_camera * found.centre();
            assert!(
                (in_world - Point3::new(x, 0.0, 0.8)).norm() < 1e-9,
                "{in_world}"
            );
            assert!((found.half_sides_m - Vector3::repeat(0.05)).norm() < 1e-9);
        }
        // What is not seen may be where it was.
        story.frame(&[0.3]);
        story.table.predict(&frame, &mut boxes);
        assert_eq!(boxes.len(), 3);
    }
}
