//! The frame loop's half of the step: which candidate is which object.

use crate::frame::{Frame, Measured};
use crate::{Config, Posterior};
use detection::Detection;
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
    /// Candidates that continued no track and began none.
    pub n_rejected: usize,
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

    /// Predicts all tracks to the frame, gives each its candidate, begins tracks
    /// for the candidates left over, and ends tracks not seen for too long.
    /// `next_id` gives ids in ascending order, `None` while there are none.
    pub fn step(
        &mut self,
        detection: &Detection,
        frame: &Frame,
        mut next_id: impl FnMut() -> Option<u64>,
        step: &mut Step,
    ) {
        step.sightings.clear();
        step.gone.clear();
        self.measure(detection, frame);
        self.predict(frame);
        self.associate(frame, step);
        self.end_lost(step);
        self.begin(frame, &mut next_id, step);
        step.n_rejected = detection.candidates.len() - step.sightings.len();
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
            let measured = Measured::of(candidate, frame).ok();
            if let Some(measured) = &measured {
                self.usable.push(i);
                self.observed
                    .push(measured.observed(candidate, frame, &self.config));
            }
            self.measured.push(measured);
        }
    }

    fn predict(&mut self, frame: &Frame) {
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

    fn begin(&mut self, frame: &Frame, next_id: &mut impl FnMut() -> Option<u64>, step: &mut Step) {
        for (candidate, measured) in self.measured.iter_mut().enumerate() {
            let Some(measured) = measured.take() else {
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
    use detection::{Candidate, Support};
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
            support: Support::Table,
            touches_image_border: false,
        }
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
            let detection = Detection {
                candidates: places.iter().map(|x| candidate_at(*x)).collect(),
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
        assert_eq!((story.ids().len(), story.step.n_rejected), (0, 1));
    }
}
