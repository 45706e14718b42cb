use super::*;
use constraint::{Constraint, ConstraintSet, Finding, Findings, Reason};
use detection::Support;
use geometry::{OrientedBox, PinholeCamera, RigidTransform};
use nalgebra::{Point3, Vector3};
use point_cloud::Rgba;
use sensor_noise::DepthNoise;
use tracking::{AssociationConfig, Measurement, MotionConfig};

mod surfaces;

const FRAME_NS: u64 = 33_333_333;

fn candidate_at(x: f64) -> Candidate {
    let frame_from_box = RigidTransform::new(Vector3::new(x, 0.0, 0.8), Vector3::zeros());
    Candidate {
        range: 0..100,
        surface: 0,
        occluded_base_m: 0.0,
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
        verdict: Ternary::True,
        decisive: ConstraintSet::NONE,
    }
}

/// A hundred grey points, shared by all objects, and a hundred blue ones of a sleeve.
fn cloud() -> Vec<Point> {
    let mut points = vec![Point::without_depth(Rgba::opaque(120, 120, 120)); 100];
    points.resize(200, Point::without_depth(Rgba::opaque(30, 40, 160)));
    points
}

/// Small candidate that is a part of a larger one.
fn small_at(x: f64) -> Candidate {
    let mut small = candidate_at(x);
    small.range = 0..40;
    small.oriented_box.half_sides_m = Vector3::repeat(0.02);
    small
}

/// Posterior as an object actor returns it for the last measurement.
fn posterior_of(track: &Track) -> Posterior {
    Posterior {
        filter: track.filter,
        view_id: track.n_views,
        is_key_view: false,
        evidence: TrackEvidence::default(),
        n_key_views: 0,
    }
}

/// Candidate with another verdict of the constraint rule.
fn candidate_with_verdict(x: f64, verdict: Ternary) -> Candidate {
    Candidate {
        verdict,
        support: None,
        ..candidate_at(x)
    }
}

/// Candidate in the space of the robot or a person.
fn body_part_at(x: f64, constraint: Constraint) -> Candidate {
    let mut body_part = candidate_with_verdict(x, Ternary::False);
    body_part.range = 100..200;
    let reason = Reason::NotEvaluated;
    let truth = Ternary::True;
    body_part.findings.set(
        constraint,
        Finding {
            value: truth,
            reason,
        },
    );
    body_part
}

/// Track table driven frame by frame, with ids counted from 1.
struct TableFixture {
    table: TrackTable,
    update: TrackUpdate,
    world_from_camera: RigidTransform,
    n_frames: u64,
    last_id: u64,
}

impl TableFixture {
    fn new() -> Self {
        let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
        let config = Config::new(motion, association, 0.75).unwrap();
        Self {
            table: TrackTable::new(config),
            update: TrackUpdate::default(),
            world_from_camera: RigidTransform::identity(),
            n_frames: 0,
            last_id: 0,
        }
    }

    /// One frame with an object at each x coordinate.
    fn frame(&mut self, places: &[f64]) {
        self.frame_of(places.iter().map(|x| candidate_at(*x)).collect());
    }

    fn frame_of(&mut self, candidates: Vec<Candidate>) {
        let detection = Detection {
            candidates,
            point_indices: (0..200).collect(),
            ..Detection::default()
        };
        self.update(&detection, &cloud(), None);
    }

    /// One frame with a detection in a cloud; an organised one has a camera.
    fn update(&mut self, detection: &Detection, cloud: &[Point], camera: Option<PinholeCamera>) {
        let frame = FramePose {
            capture_ns: self.n_frames * FRAME_NS,
            world_from_camera: self.world_from_camera,
            up_in_camera: None,
            camera,
        };
        self.n_frames += 1;
        let last_id = &mut self.last_id;
        let next_id = || {
            *last_id += 1;
            Some(*last_id)
        };
        self.table.predict(&frame, &mut Vec::new());
        self.table
            .update(detection, cloud, &frame, next_id, &mut self.update);
    }

    /// Frames with an object at each x coordinate, until its track is confirmed.
    fn confirm(&mut self, places: &[f64]) {
        for _ in 0..3 {
            self.frame(places);
        }
    }

    fn ids(&self) -> Vec<u64> {
        self.table.tracks().iter().map(|track| track.id).collect()
    }
}

#[test]
fn objects_keep_their_ids_and_new_ones_get_the_next() {
    let mut fixture = TableFixture::new();
    for _ in 0..10 {
        fixture.frame(&[0.0, 0.3]);
    }
    assert_eq!(fixture.ids(), [1, 2]);
    for n_tracks in [2, 2, 3] {
        fixture.frame(&[0.3, 0.6, 0.0]);
        assert_eq!(fixture.ids().len(), n_tracks, "certain in the third frame");
        assert_eq!(fixture.update.rejected_candidates, [0_usize; 0]);
    }
    assert_eq!(fixture.ids(), [1, 2, 3]);
    let new = fixture
        .update
        .sightings
        .iter()
        .filter(|sighting| sighting.is_new);
    assert_eq!(
        new.map(|sighting| sighting.track_id).collect::<Vec<_>>(),
        [3]
    );
}

#[test]
fn an_unseen_track_coasts_briefly_and_times_out() {
    let mut fixture = TableFixture::new();
    for _ in 0..10 {
        fixture.frame(&[0.0]);
    }
    for _ in 0..40 {
        fixture.frame(&[]);
        let place = fixture.table.tracks()[0].box_in_world().centre();
        assert!(place.x.abs() < 0.05, "{place}");
    }
    for _ in 0..270 {
        fixture.frame(&[]);
    }
    assert_eq!(fixture.ids(), [0_u64; 0]);
}

/// Live tracks after an object in front of a wall has vanished from images of a camera
/// with this law of the depth noise.
fn n_tracks_before_a_wall(depth_noise: DepthNoise) -> usize {
    let camera = PinholeCamera::KINECT_V1;
    let on_wall = Point {
        z: 0.87,
        ..Point::without_depth(Rgba::opaque(120, 120, 120))
    };
    let wall = vec![on_wall; camera.n_pixels()];
    let mut fixture = TableFixture::new();
    for is_there in [true, true, true, false, false, false, false, false] {
        let detection = Detection {
            candidates: if is_there {
                vec![candidate_at(0.0)]
            } else {
                vec![]
            },
            point_indices: (0..100).collect(),
            depth_noise,
            ..Detection::default()
        };
        fixture.update(&detection, &wall, Some(camera));
    }
    fixture.ids().len()
}

#[test]
fn a_track_ends_in_free_space_beyond_the_depth_noise() {
    // The wall is 20 mm behind the object; four sigmas of the noise are 6 and 24 mm.
    assert_eq!(n_tracks_before_a_wall(DepthNoise::KINECT_V1), 0);
    assert_eq!(n_tracks_before_a_wall(DepthNoise::KINECT_V1.scaled(4.0)), 1);
}

#[test]
fn a_track_is_measured_with_the_depth_noise_of_the_camera() {
    let variances_m2 = [DepthNoise::KINECT_V1, DepthNoise::KINECT_V1.scaled(4.0)].map(|law| {
        let mut fixture = TableFixture::new();
        let detection = Detection {
            candidates: vec![candidate_at(fixture.n_frames as f64)],
            point_indices: (0..100).collect(),
            depth_noise: law,
            ..Detection::default()
        };
        for _ in 0..3 {
            fixture.update(&detection, &cloud(), None);
        }
        let track = fixture.table.tracks().last().unwrap();
        track.position_covariance_m2()[(2, 2)]
    });
    assert!(variances_m2[1] > 2.0 * variances_m2[0], "{variances_m2:?}");
}

#[test]
fn no_track_starts_without_an_id_and_clearing_ends_all() {
    let mut fixture = TableFixture::new();
    fixture.confirm(&[0.0]);
    let mut gone = Vec::new();
    fixture.table.clear(&mut gone);
    assert_eq!((gone, fixture.ids()), (vec![1], vec![]));
    let detection = Detection {
        candidates: vec![candidate_at(0.0)],
        point_indices: (0..200).collect(),
        ..Detection::default()
    };
    let mut frame = FramePose {
        capture_ns: 1,
        world_from_camera: RigidTransform::identity(),
        up_in_camera: None,
        camera: None,
    };
    let mut ids_after = |next_id: Option<u64>| {
        frame.capture_ns += FRAME_NS;
        fixture.table.predict(&frame, &mut Vec::new());
        fixture.table.update(
            &detection,
            &cloud(),
            &frame,
            || next_id,
            &mut fixture.update,
        );
        fixture.ids()
    };
    for _ in 0..6 {
        assert_eq!(ids_after(None), [0_u64; 0]);
    }
    assert_eq!(ids_after(Some(7)), [7], "the object has waited for an id");
}

#[test]
fn only_an_accepted_candidate_starts_a_track() {
    let mut fixture = TableFixture::new();
    for _ in 0..3 {
        fixture.frame_of(vec![
            candidate_with_verdict(0.0, Ternary::False),
            candidate_at(0.3),
            candidate_with_verdict(0.6, Ternary::Unknown),
        ]);
    }
    assert_eq!(fixture.ids(), [1]);
    assert_eq!(fixture.update.sightings[0].candidate, 1);
    assert_eq!(fixture.update.rejected_candidates, [0, 2]);
}

#[test]
fn a_track_continues_regardless_of_the_rule() {
    for verdict in [Ternary::False, Ternary::Unknown] {
        let mut fixture = TableFixture::new();
        fixture.confirm(&[0.0]);
        for _ in 0..60 {
            fixture.frame_of(vec![candidate_with_verdict(0.0, verdict)]);
            assert_eq!(fixture.table.tracks()[0].visibility(), Visibility::Visible);
        }
        assert_eq!(
            (fixture.ids(), fixture.update.rejected_candidates.len()),
            (vec![1], 0)
        );
    }
}

#[test]
fn a_track_never_continues_with_a_hand_or_the_arm() {
    for constraint in [Constraint::Robot, Constraint::Instructor] {
        let mut fixture = TableFixture::new();
        fixture.confirm(&[0.0]);
        fixture.frame_of(vec![body_part_at(0.0, constraint)]);
        assert_ne!(fixture.table.tracks()[0].visibility(), Visibility::Visible);
        assert_eq!(fixture.update.rejected_candidates, [0]);
        let oversized = Candidate {
            is_object_sized: false,
            ..candidate_at(0.0)
        };
        fixture.frame_of(vec![oversized]);
        assert_ne!(fixture.table.tracks()[0].visibility(), Visibility::Visible);
        // A held object lies in the space of the hand but has its own appearance.
        let mut held = body_part_at(0.0, constraint);
        held.range = 0..100;
        fixture.frame_of(vec![held]);
        assert_eq!(fixture.table.tracks()[0].visibility(), Visibility::Visible);
        assert_eq!(fixture.ids(), [1]);
    }
}

#[test]
fn a_hand_that_covers_an_object_does_not_shrink_its_track() {
    let mut fixture = TableFixture::new();
    for _ in 0..20 {
        fixture.frame(&[0.0]);
    }
    let mut touched = candidate_with_verdict(0.0, Ternary::Unknown);
    touched.oriented_box.half_sides_m.z = 0.02;
    let truth = Ternary::Unknown;
    let reason = Reason::NotEvaluated;
    touched.findings.set(
        Constraint::Instructor,
        Finding {
            value: truth,
            reason,
        },
    );
    for _ in 0..20 {
        fixture.frame_of(vec![touched.clone()]);
    }
    let track = &fixture.table.tracks()[0];
    assert!(
        track.visibility() == Visibility::Visible
            && track.measured.is_truncated
            && !track.measured.is_truncated_by_image
    );
    assert!(
        track.appearance.volume_m3 > 0.9e-3,
        "{:?}",
        track.appearance
    );
}

#[test]
fn duplicate_tracks_are_merged() {
    let mut fixture = TableFixture::new();
    fixture.frame_of(vec![candidate_at(0.0), small_at(0.3)]);
    fixture.frame_of(vec![candidate_at(0.0), small_at(0.3)]);
    fixture.frame_of(vec![candidate_at(0.0), small_at(0.3)]);
    assert_eq!(fixture.ids(), [1, 2]);
    // The second track has ended up in the first, which detection sees as a whole.
    let shape = |track: &Track, x: f64| {
        let mut moved = track.measured.measurement;
        moved = Measurement::new(
            moved.stamp_ns(),
            OrientedBox {
                frame_from_box: RigidTransform::translation(x, 0.0, 0.8),
                ..*moved.box_in_world()
            },
            *moved.conditions(),
        )
        .unwrap();
        MotionFilter::start(&moved, &MotionConfig::default())
    };
    let inside = shape(&fixture.table.tracks[1], 0.02);
    fixture.table.tracks[1].updated_filter = inside;
    for _ in 0..3 {
        fixture.frame(&[0.0]);
    }
    assert_eq!(fixture.ids(), [1]);
}

#[test]
fn a_returning_object_is_reidentified() {
    let mut fixture = TableFixture::new();
    fixture.confirm(&[0.0]);
    for _ in 0..10 {
        fixture.frame(&[0.0]);
        let posterior = posterior_of(&fixture.table.tracks()[0]);
        fixture.table.apply_posterior(1, &posterior);
    }
    for _ in 0..310 {
        fixture.frame(&[]);
    }
    assert_eq!(fixture.ids(), [0_u64; 0]);
    fixture.confirm(&[0.4]);
    assert_eq!(fixture.table.tracks()[0].reidentified_as, Some(1));
    fixture.confirm(&[0.4, 0.9]);
    assert_eq!(
        fixture.table.tracks()[1].reidentified_as,
        None,
        "the lost track was re-identified already"
    );
}

#[test]
fn prediction_supplies_the_boxes_of_the_tracks() {
    let mut fixture = TableFixture::new();
    fixture.confirm(&[0.0, 0.3]);
    let world_from_camera =
        RigidTransform::new(Vector3::new(0.5, -0.2, 1.0), Vector3::new(2.0, 0.1, 0.0));
    let frame = FramePose {
        capture_ns: 3 * FRAME_NS,
        world_from_camera,
        up_in_camera: None,
        camera: None,
    };
    let mut boxes = vec![];
    fixture.table.predict(&frame, &mut boxes);
    assert_eq!(boxes.len(), 2);
    for (found, x) in boxes.iter().zip([0.0, 0.3]) {
        let in_world = world_from_camera * found.oriented_box.centre();
        assert!(
            (in_world - Point3::new(x, 0.0, 0.8)).norm() < 1e-9,
            "{in_world}"
        );
        assert!((found.oriented_box.half_sides_m - Vector3::repeat(0.05)).norm() < 1e-9);
    }
    // An unseen object may still be where it was.
    fixture.frame(&[0.3]);
    fixture.table.predict(&frame, &mut boxes);
    assert_eq!(boxes.len(), 3);
}

#[test]
fn duplicate_tracks_that_fill_the_same_space_are_merged() {
    let mut fixture = TableFixture::new();
    fixture.confirm(&[0.0, 0.3]);
    // The second track was started from a part of the first one's object and has grown.
    let grown = fixture.table.tracks[0].updated_filter;
    fixture.table.tracks[1].updated_filter = grown;
    let slice_at = |x: f64| {
        let mut slice = candidate_at(x);
        slice.oriented_box.half_sides_m.x = 0.02;
        slice
    };
    for _ in 0..3 {
        fixture.frame_of(vec![slice_at(-0.025), slice_at(0.025)]);
    }
    assert_eq!(fixture.ids(), [1]);
    assert!(
        fixture
            .update
            .sightings
            .iter()
            .all(|seen| seen.track_id == 1)
    );
}

#[test]
fn no_track_starts_in_the_space_of_a_visible_one() {
    let mut fixture = TableFixture::new();
    fixture.confirm(&[0.0]);
    for _ in 0..5 {
        fixture.frame_of(vec![candidate_at(0.0), small_at(0.02)]);
    }
    assert_eq!(fixture.ids(), [1]);
    for _ in 0..3 {
        fixture.frame_of(vec![candidate_at(0.0), small_at(0.12)]);
    }
    assert_eq!(fixture.ids(), [1, 2]);
}

#[test]
fn an_unseen_track_without_a_hand_stays_where_it_was() {
    let mut fixture = TableFixture::new();
    fixture.confirm(&[0.0]);
    // The innovations of a wrong camera pose look like motion.
    for frame in 1..10 {
        fixture.frame(&[0.02 * f64::from(frame)]);
        let track = &fixture.table.tracks()[0];
        let measurement = track.measured.measurement;
        let config = *fixture.table.config.motion();
        let filter = track.updated_filter.updated(&measurement, None, &config);
        let posterior = Posterior {
            filter: filter.unwrap(),
            ..posterior_of(track)
        };
        fixture.table.apply_posterior(1, &posterior);
    }
    let last = fixture.table.tracks()[0].updated_filter;
    assert!(last.velocity_m_s().x > 0.1, "{}", last.velocity_m_s());
    fixture.frame(&[]);
    fixture.frame(&[]);
    let place = fixture.table.tracks()[0].box_in_world().centre();
    assert!(
        (place - last.box_in_world().centre()).norm() < 1e-9,
        "{place}"
    );
}

/// Two tracks, of which a hand has just pushed the first towards the second, to about 0.13 m from
/// it.
fn pushed_towards_a_neighbour() -> TableFixture {
    let mut fixture = TableFixture::new();
    let touched_at = |x: f64| {
        let mut touched = candidate_at(x);
        let finding = Finding {
            value: Ternary::Unknown,
            reason: Reason::NotEvaluated,
        };
        touched.findings.set(Constraint::Instructor, finding);
        touched
    };
    fixture.confirm(&[0.0, 0.25]);
    for frame in 1..=10 {
        let moved = touched_at(0.012 * f64::from(frame));
        fixture.frame_of(vec![moved, candidate_at(0.25)]);
        observe(&mut fixture);
    }
    fixture
}

#[test]
fn an_unseen_track_does_not_coast_into_a_visible_one() {
    let mut fixture = pushed_towards_a_neighbour();
    let mut farthest_m = f64::MIN;
    for _ in 0..25 {
        fixture.frame_of(vec![candidate_at(0.25)]);
        observe(&mut fixture);
        farthest_m = farthest_m.max(fixture.table.tracks()[0].box_in_world().centre().x);
    }
    assert!((0.13..0.18).contains(&farthest_m), "{farthest_m}");
    assert_eq!(fixture.ids(), [1, 2]);
}

#[test]
fn an_unseen_track_does_not_continue_with_a_part_of_its_neighbour() {
    let mut fixture = pushed_towards_a_neighbour();
    let part_at = |x: f64| {
        let mut part = candidate_at(x);
        part.oriented_box.half_sides_m.x = 0.03;
        part
    };
    for _ in 0..5 {
        fixture.frame_of(vec![part_at(0.22), candidate_at(0.25)]);
        observe(&mut fixture);
        let tracks = fixture.table.tracks();
        assert_ne!(tracks[0].visibility(), Visibility::Visible);
        assert_eq!(tracks[1].visibility(), Visibility::Visible);
        assert_eq!(fixture.update.rejected_candidates, [0]);
    }
    fixture.frame_of(vec![part_at(0.15), candidate_at(0.25)]);
    let first = &fixture.table.tracks()[0];
    assert_eq!(first.visibility(), Visibility::Visible, "its own part");
}

/// Applies the posteriors of the objects that were seen in the last frame.
fn observe(fixture: &mut TableFixture) {
    let config = *fixture.table.config.motion();
    for sighting in &fixture.update.sightings {
        let tracks = fixture.table.tracks();
        let track = tracks.iter().find(|track| track.id == sighting.track_id);
        let track = track.unwrap();
        let measurement = &sighting.measured.measurement;
        let posterior = Posterior {
            filter: (track.updated_filter)
                .updated(measurement, None, &config)
                .unwrap(),
            ..posterior_of(track)
        };
        fixture.table.apply_posterior(sighting.track_id, &posterior);
    }
}

#[test]
fn an_object_is_expected_where_the_others_have_shifted_to() {
    let large_at = |x: f64| {
        let mut large = candidate_at(x);
        large.oriented_box.half_sides_m = Vector3::repeat(0.2);
        large
    };
    // Ids after a wrong camera pose shifts the large objects, whose gates are wide, and the
    // small one.
    let ids_after = |shift_of_large_m: f64, shift_of_small_m: f64| {
        let mut fixture = TableFixture::new();
        for _ in 0..30 {
            fixture.frame_of(vec![large_at(0.0), large_at(0.6), candidate_at(1.2)]);
            observe(&mut fixture);
        }
        let large = [0.0, 0.6].map(|x| large_at(x + shift_of_large_m));
        let small = candidate_at(1.2 + shift_of_small_m);
        for _ in 0..3 {
            let shifted = large.iter().cloned().chain([small.clone()]);
            fixture.frame_of(shifted.collect());
        }
        fixture.ids()
    };
    assert_eq!(ids_after(0.05, 0.05), [1, 2, 3]);
    assert_eq!(ids_after(0.05, 0.06), [1, 2, 3]);
    assert_eq!(ids_after(0.0, 0.05), [1, 2, 3, 4]);
    assert_eq!(ids_after(-0.05, 0.05), [1, 2, 3, 4]);
}

#[test]
fn a_part_at_the_image_border_starts_no_track_where_a_kept_one_is_out_of_view() {
    let on_wall = Point {
        z: 1.5,
        ..Point::without_depth(Rgba::opaque(120, 120, 120))
    };
    let mut wall = vec![on_wall; PinholeCamera::KINECT_V1.n_pixels()];
    for point in &mut wall[100..200] {
        point.color = Rgba::opaque(30, 40, 160);
    }
    let n_tracks_after = |part: Candidate, camera_x: f64| {
        let mut fixture = TableFixture::new();
        let show = |fixture: &mut TableFixture, candidate: Option<Candidate>| {
            let detection = Detection {
                candidates: candidate.into_iter().collect(),
                point_indices: (0..200).collect(),
                ..Detection::default()
            };
            fixture.update(&detection, &wall, Some(PinholeCamera::KINECT_V1));
        };
        for _ in 0..3 {
            show(&mut fixture, Some(candidate_at(0.0)));
        }
        fixture.world_from_camera = RigidTransform::translation(camera_x, 0.0, 0.0);
        show(&mut fixture, None);
        for _ in 0..3 {
            show(&mut fixture, Some(part.clone()));
        }
        fixture.ids().len()
    };
    // The corner of an object that returns 10 cm beside its place, in a camera at 0.6 m.
    let part = |place_x: f64, is_cut: bool| {
        let mut part = small_at(place_x - 0.6);
        part.oriented_box.frame_from_box.translation.vector.y = 0.13;
        part.touches_image_border = is_cut;
        part
    };
    assert_eq!(n_tracks_after(part(0.1, true), 0.6), 1);
    assert_eq!(n_tracks_after(part(0.1, false), 0.6), 2, "seen whole");
    assert_eq!(n_tracks_after(part(0.3, true), 0.6), 2, "another object");
    let blue = Candidate {
        range: 100..200,
        ..part(0.1, true)
    };
    assert_eq!(n_tracks_after(blue, 0.6), 2, "of another colour");
}

#[test]
fn an_object_is_at_rest_unless_something_near_it_is_handled() {
    let is_at_rest = |body_x: Option<f64>| {
        let mut fixture = TableFixture::new();
        fixture.confirm(&[0.0]);
        let body = body_x.map(|x| body_part_at(x, Constraint::Instructor));
        fixture.frame_of([candidate_at(0.0)].into_iter().chain(body).collect());
        let mut sightings = fixture.update.sightings.iter();
        let seen = sightings.find(|seen| seen.track_id == 1).unwrap();
        seen.measured.measurement.is_at_rest()
    };
    assert!(is_at_rest(None));
    assert!(is_at_rest(Some(0.5)));
    assert!(!is_at_rest(Some(0.25)));
}

#[test]
fn a_shift_that_all_objects_share_is_noise_of_the_camera_pose() {
    let pose_noise = |places: &[f64]| {
        let mut fixture = TableFixture::new();
        fixture.confirm(&[0.0, 0.3, 0.6]);
        fixture.frame(places);
        let sigmas = fixture.update.sightings.iter();
        sigmas
            .map(|seen| seen.measured.measurement.pose_sigma_m())
            .fold(0.0, f64::max)
    };
    assert!(pose_noise(&[0.02, 0.32, 0.62]) > 0.05);
    assert_eq!(pose_noise(&[0.02, 0.3, 0.6]), 0.0);
    assert_eq!(pose_noise(&[0.002, 0.302, 0.602]), 0.0);
}

#[test]
fn object_beside_a_larger_one_is_a_track_after_half_a_second() {
    let n_frames = |part_x: f64| {
        let mut fixture = TableFixture::new();
        (1..60).find(|_| {
            fixture.frame_of(vec![candidate_at(0.0), small_at(part_x)]);
            fixture.ids().len() == 2
        })
    };
    assert_eq!(n_frames(0.2), Some(3));
    assert_eq!(n_frames(0.08), Some(15));
}

#[test]
fn cluster_that_comes_and_goes_neither_starts_nor_ends_a_track() {
    let mut fixture = TableFixture::new();
    for frame in 0..200 {
        let is_apart = frame % 3 == 0;
        let part = is_apart.then(|| small_at(0.08));
        fixture.frame_of([candidate_at(0.0)].into_iter().chain(part).collect());
        assert!(fixture.update.ended_tracks.is_empty());
    }
    assert_eq!((fixture.ids(), fixture.last_id), (vec![1], 1));
}
