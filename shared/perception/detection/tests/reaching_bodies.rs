//! Body segmentation in depth on rendered tables: an arm is a person, an object is not.

mod synthetic;

use constraint::{Constraint, Finding, Reason, Ternary};
use detection::{
    BodyMap, Candidate, Config, Detection, DetectionInput, Execution, ExpectedTrack, ScenePriors,
    Workspace, detect,
};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use point_cloud::{ColorHistogram, OrganizedCloud, Rgba};
use synthetic::{BoxOnTable, camera_from_table, render};

const fn solid(centre: [f64; 2], bottom: f64, sides: [f64; 3]) -> BoxOnTable {
    BoxOnTable {
        centre,
        bottom,
        sides,
        rgb: [200, 140, 110],
    }
}

/// Object that stands on the table.
const OBJECT: BoxOnTable = solid([-0.25, 0.0], 0.0, [0.10, 0.08, 0.12]);

/// Arm over the table's rear border, its underside `height_m` above the table.
const fn arm(height_m: f64) -> BoxOnTable {
    solid([0.1, 0.35], height_m, [0.08, 0.7, 0.07])
}

fn search(boxes: &[BoxOnTable], priors: ScenePriors<'_>) -> Detection {
    let points = render(boxes, 1.0);
    let mut detection = Detection::default();
    let frame = DetectionInput {
        cloud: OrganizedCloud::new(&points, 640, 480).expect("a full grid"),
        up_in_camera: None,
        priors,
    };
    let mut workspace = Workspace::default();
    let execution = Execution::default();
    detect(
        &frame,
        &Config::default(),
        &mut workspace,
        &mut detection,
        execution,
    )
    .expect("an organised cloud");
    detection
}

/// Priors with the bodies of the previous frame.
fn after(bodies: &BodyMap) -> ScenePriors<'_> {
    ScenePriors {
        bodies: Some(bodies),
        ..ScenePriors::default()
    }
}

/// Number of frames after which motion is measured.
const N_FRAMES_BEFORE: usize = 11;

/// Bodies of the last of some frames that show boxes.
fn bodies_after_watching(boxes: &[BoxOnTable]) -> BodyMap {
    let mut bodies = BodyMap::default();
    for _ in 0..N_FRAMES_BEFORE {
        bodies = search(boxes, after(&bodies)).bodies;
    }
    bodies
}

/// Detection in the first frame with `arrived` after frames with `before` only.
fn search_arrival(before: &[BoxOnTable], arrived: &[BoxOnTable]) -> Detection {
    let bodies = bodies_after_watching(before);
    search(&[before, arrived].concat(), after(&bodies))
}

/// Candidate with its centre nearest to a place in the table's frame.
fn near(detection: &Detection, place: [f64; 3]) -> &Candidate {
    let place = camera_from_table() * Point3::from(place);
    let away = |one: &&Candidate| (one.oriented_box.centre() - place).norm();
    let candidates = detection.candidates.iter();
    let nearest = candidates.min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.expect("a candidate")
}

fn person(candidate: &Candidate) -> Finding {
    candidate.findings.get(Constraint::Instructor)
}

#[test]
fn an_arm_over_the_table_is_a_person_and_an_object_is_not() {
    let detection = search_arrival(&[OBJECT], &[arm(0.08)]);
    assert!(detection.bodies.is_any());
    let found = near(&detection, [0.1, 0.2, 0.12]);
    assert_eq!(person(found).reason, Reason::ReachesOverTable);
    assert_eq!(found.verdict, Ternary::False);
    let object = near(&detection, [-0.25, 0.0, 0.06]);
    assert_eq!(person(object).reason, Reason::NotPerson);
    assert_eq!(object.verdict, Ternary::True);
}

#[test]
fn objects_at_the_rim_and_over_it_are_no_person() {
    let at_rear_rim = solid([0.0, 0.35], 0.0, [0.10, 0.10, 0.25]);
    let over_rear_rim = solid([0.3, 0.38], 0.0, [0.20, 0.14, 0.03]);
    let over_side_rim = solid([-0.58, 0.0], 0.0, [0.14, 0.10, 0.05]);
    let detection = search_arrival(&[OBJECT], &[at_rear_rim, over_rear_rim, over_side_rim]);
    assert!(!detection.bodies.is_any());
    for candidate in &detection.candidates {
        assert_eq!(person(candidate).reason, Reason::NoPersonKnown);
    }
}

/// A tall thing that overhangs the table, and was there before, is no arm.
#[test]
fn what_does_not_move_is_no_person() {
    let scene = [OBJECT, arm(0.08)];
    let detection = search(&scene, after(&bodies_after_watching(&scene)));
    assert!(!detection.bodies.is_any());
    let single_frame = search(&scene, ScenePriors::default());
    assert!(!single_frame.bodies.is_any());
}

/// A camera that moves sees still things at other places of the image.
#[test]
fn what_the_motion_of_the_camera_explains_is_no_motion() {
    let scene = [OBJECT, arm(0.08)];
    let shifted = |shift_m: f64| {
        let bodies = bodies_after_watching(&scene);
        let priors = ScenePriors {
            world_from_camera: RigidTransform::new(Vector3::x() * shift_m, Vector3::zeros()),
            ..after(&bodies)
        };
        search(&scene, priors).bodies.is_any()
    };
    assert!(!shifted(0.01), "a small error of the pose");
    assert!(
        shifted(0.15),
        "the camera is said to have moved along with the scene"
    );
}

/// An arm that puts a box down is connected with a box that stands.
#[test]
fn a_body_goes_on_while_it_holds_what_stands() {
    let held = |height_m: f64| {
        [
            OBJECT,
            arm(height_m + 0.09),
            solid([0.1, 0.02], height_m, [0.14, 0.12, 0.10]),
        ]
    };
    let lifted = search_arrival(&[OBJECT], &held(0.05)[1..]);
    assert!(lifted.bodies.is_any());
    let put_down = search(&held(0.0), after(&lifted.bodies));
    let box_and_hand = near(&put_down, [0.1, 0.1, 0.08]);
    assert_eq!(person(box_and_hand).value, Ternary::True);
    // The hand has left.
    let alone = [OBJECT, held(0.0)[2]];
    let released = search(&alone, after(&put_down.bodies));
    assert!(!released.bodies.is_any());
    let object = near(&released, [0.1, 0.02, 0.05]);
    assert_eq!(object.verdict, Ternary::True);
}

/// Without evidence of its own a body ends after some frames.
#[test]
fn a_body_without_evidence_ends() {
    let lifted = search_arrival(&[OBJECT], &[arm(0.08)]);
    let on_the_table = [OBJECT, arm(0.0)];
    let mut bodies = lifted.bodies;
    let n_frames = (1..100)
        .find(|_| {
            bodies = search(&on_the_table, after(&bodies)).bodies;
            !bodies.is_any()
        })
        .expect("an end");
    assert!((2..=60).contains(&n_frames), "{n_frames}");
}

#[test]
fn what_a_hand_holds_stays_with_its_track() {
    let held = solid([0.1, -0.02], 0.05, [0.08, 0.08, 0.10]);
    let hand = solid([0.1, 0.33], 0.15, [0.08, 0.70, 0.05]);
    let middle = Vector3::new(0.1, -0.02, 0.10);
    let oriented_box = OrientedBox {
        frame_from_box: Isometry3::from_parts(middle.into(), UnitQuaternion::identity()),
        half_sides_m: Vector3::new(0.04, 0.04, 0.05),
    };
    let track = ExpectedTrack {
        oriented_box: oriented_box.transformed(&camera_from_table()),
        n_points: 2000,
        is_handled: false,
        colors: None,
    };
    let bodies = bodies_after_watching(&[OBJECT, held]);
    let priors = ScenePriors {
        tracks: &[track],
        ..after(&bodies)
    };
    let detection = search(&[OBJECT, held, hand], priors);
    let object = near(&detection, [0.1, -0.02, 0.10]);
    assert_eq!(person(object).value, Ternary::Unknown, "touched");
    let middle = camera_from_table() * Point3::new(0.1, -0.02, 0.10);
    assert!((object.oriented_box.centre() - middle).norm() < 0.02);
    let arm = near(&detection, [0.1, 0.2, 0.17]);
    assert_eq!(person(arm).reason, Reason::ReachesOverTable);
}

/// A hand has come into the expected box of a track.
#[test]
fn the_colours_tell_a_hand_from_the_object_in_the_box_of_a_track() {
    let held = BoxOnTable {
        rgb: [40, 60, 190],
        ..solid([0.1, -0.02], 0.0, [0.08, 0.08, 0.10])
    };
    let hand = solid([0.1, 0.30], 0.10, [0.06, 0.70, 0.05]);
    let middle = Vector3::new(0.1, -0.02, 0.07);
    let oriented_box = OrientedBox {
        frame_from_box: Isometry3::from_parts(middle.into(), UnitQuaternion::identity()),
        half_sides_m: Vector3::new(0.04, 0.04, 0.08),
    };
    let bodies = bodies_after_watching(&[OBJECT, held]);
    let n_of_the_hand = |colors: Option<ColorHistogram>| {
        let track = ExpectedTrack {
            oriented_box: oriented_box.transformed(&camera_from_table()),
            n_points: 2000,
            is_handled: false,
            colors,
        };
        let priors = ScenePriors {
            tracks: &[track],
            ..after(&bodies)
        };
        let detection = search(&[OBJECT, held, hand], priors);
        assert!(detection.bodies.is_any());
        let object = near(&detection, [0.1, -0.02, 0.05]);
        let points = render(&[OBJECT, held, hand], 1.0);
        let is_of_the_hand = |pixel: &&u32| {
            let point = points[**pixel as usize].position();
            (camera_from_table().inverse() * point).z > 0.11
        };
        let pixels = detection.points_of(object).iter();
        pixels.filter(is_of_the_hand).count()
    };
    let blue = ColorHistogram::from_colors([Rgba::opaque(40, 60, 190); 50]);
    let [without_colors, with_colors] = [None, Some(blue)].map(n_of_the_hand);
    assert!(without_colors > 500, "{without_colors}");
    assert!(with_colors < without_colors / 20, "{with_colors}");
}

/// The torso behind an arm: the lower contour of what enters over the rear border is hidden.
#[test]
fn what_an_arm_hides_from_below_is_of_the_person() {
    let torso = solid([0.1, 0.62], 0.05, [0.30, 0.10, 0.60]);
    let detection = search_arrival(&[OBJECT], &[arm(0.08), torso]);
    let of_objects = detection
        .candidates
        .iter()
        .filter(|candidate| candidate.verdict == Ternary::True);
    assert_eq!(of_objects.count(), 1);
}
