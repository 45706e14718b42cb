use super::*;
use constraint::{Constraint, ConstraintSet, Finding, Findings, Reason};
use geometry::OrientedBox;
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use point_cloud::Rgba;
use tracking::{AssociationConfig, MotionConfig};

const FRAME_NS: u64 = 33_333_333;

fn candidate_at(x: f64) -> Candidate {
    let frame_from_box = RigidTransform::new(Vector3::new(x, 0.0, 0.8), Vector3::zeros());
    Candidate {
        range: 0..100,
        unseen_foot_m: 0.0,
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

/// A hundred grey points, which all objects share, and a hundred of a sleeve.
fn cloud() -> Vec<Point> {
    let mut points = vec![Point::without_depth(Rgba::opaque(120, 120, 120)); 100];
    points.resize(200, Point::without_depth(Rgba::opaque(30, 40, 160)));
    points
}

/// A part of the object beside it.
fn small_at(x: f64) -> Candidate {
    let mut small = candidate_at(x);
    small.oriented_box.half_sides_m = Vector3::repeat(0.02);
    small
}

/// What an actor would answer to the last sighting of a track.
fn posterior_of(track: &Track) -> Posterior {
    Posterior {
        filter: track.filter,
        view_id: track.n_views,
        is_key_view: false,
        label: None,
        distance: f32::INFINITY,
        probability: None,
        nearest: Default::default(),
        n_key_views: 0,
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
    limb.range = 100..200;
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
            point_indices: (0..200).collect(),
            ..Detection::default()
        };
        let frame = Frame {
            capture_ns: self.n_frames * FRAME_NS,
            world_from_camera: RigidTransform::identity(),
            camera: None,
        };
        self.n_frames += 1;
        let last_id = &mut self.last_id;
        let next_id = || {
            *last_id += 1;
            Some(*last_id)
        };
        self.table
            .step(&detection, &cloud(), &frame, next_id, &mut self.step);
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
        point_indices: (0..200).collect(),
        ..Detection::default()
    };
    let frame = Frame {
        capture_ns: 1,
        world_from_camera: RigidTransform::identity(),
        camera: None,
    };
    story
        .table
        .step(&detection, &cloud(), &frame, || None, &mut story.step);
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
            assert_eq!(story.table.tracks()[0].sight(), Sight::Seen);
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
        assert_ne!(story.table.tracks()[0].sight(), Sight::Seen);
        assert_eq!(story.step.rejected, [0]);
        let oversized = Candidate {
            is_object_sized: false,
            ..candidate_at(0.0)
        };
        story.frame_of(vec![oversized]);
        assert_ne!(story.table.tracks()[0].sight(), Sight::Seen);
        // What a hand holds lies where the hand is, and looks like the object.
        let mut held = limb_at(0.0, constraint);
        held.range = 0..100;
        story.frame_of(vec![held]);
        assert_eq!(story.table.tracks()[0].sight(), Sight::Seen);
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
    assert!(
        track.sight() == Sight::Seen && track.measured.is_cut && !track.measured.is_cut_by_image
    );
    assert!(
        track.appearance.volume_m3 > 0.9e-3,
        "{:?}",
        track.appearance
    );
}

#[test]
fn two_tracks_of_one_object_become_one() {
    let mut story = Story::new();
    story.frame_of(vec![candidate_at(0.0), small_at(0.02)]);
    story.frame_of(vec![candidate_at(0.0), small_at(0.02)]);
    assert_eq!(story.ids(), [1, 2]);
    // Now and then detection sees the whole.
    for _ in 0..3 {
        story.frame(&[0.0]);
    }
    assert_eq!(story.ids(), [1]);
}

#[test]
fn what_comes_back_is_linked_to_what_it_was() {
    let mut story = Story::new();
    for _ in 0..10 {
        story.frame(&[0.0]);
        let posterior = posterior_of(&story.table.tracks()[0]);
        story.table.absorb(1, &posterior);
    }
    for _ in 0..60 {
        story.frame(&[]);
    }
    assert_eq!(story.ids(), [0_u64; 0]);
    story.frame(&[0.4]);
    assert_eq!(story.table.tracks()[0].linked_to, Some(1));
    story.frame(&[0.4, 0.9]);
    assert_eq!(
        story.table.tracks()[1].linked_to,
        None,
        "it is back already"
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
        camera: None,
    };
    let mut boxes = vec![];
    story.table.predict(&frame, &mut boxes);
    assert_eq!(boxes.len(), 2);
    for (found, x) in boxes.iter().zip([0.0, 0.3]) {
        let in_world = world_from_camera * found.shape.centre();
        assert!(
            (in_world - Point3::new(x, 0.0, 0.8)).norm() < 1e-9,
            "{in_world}"
        );
        assert!((found.shape.half_sides_m - Vector3::repeat(0.05)).norm() < 1e-9);
    }
    // What is not seen may be where it was.
    story.frame(&[0.3]);
    story.table.predict(&frame, &mut boxes);
    assert_eq!(boxes.len(), 3);
}
