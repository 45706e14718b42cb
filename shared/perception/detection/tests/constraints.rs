//! Constraint evaluation on rendered tables with known ground truth.

mod synthetic;

use constraint::{Assumption, Constraint, Expression, Findings, Reason, Ternary};
use detection::{
    Candidate, Config, Detection, DetectionInput, Execution, ExpectedTrack, RawConfig, ScenePriors,
    Workspace, detect,
};
use geometry::{Capsule, OrientedBox, RigidTransform};
use nalgebra::{Isometry3, Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};
use std::f64::consts::FRAC_PI_4;
use synthetic::{BoxOnTable, camera_from_table, render};

const MIDDLE: BoxOnTable = BoxOnTable {
    centre: [0.0, 0.0],
    bottom: 0.0,
    sides: [0.10, 0.08, 0.12],
    rgb: [200, 30, 30],
};

fn box_at(x: f64, y: f64, sides: [f64; 3]) -> BoxOnTable {
    BoxOnTable {
        centre: [x, y],
        sides,
        ..MIDDLE
    }
}

fn found(points: &[Point], surroundings: ScenePriors<'_>, config: &Config) -> Detection {
    let mut detection = Detection::default();
    let frame = DetectionInput {
        cloud: OrganizedCloud::new(points, 640, 480).expect("a full grid"),
        up_in_camera: None,
        priors: surroundings,
    };
    detect(
        &frame,
        config,
        &mut Workspace::default(),
        &mut detection,
        Execution::default(),
    )
    .expect("an organised cloud");
    detection
}

fn found_plainly(boxes: &[BoxOnTable]) -> Detection {
    let points = render(boxes, 1.0);
    found(&points, ScenePriors::default(), &Config::default())
}

/// Candidate with its box centre nearest to a point of the table's frame.
fn near(detection: &Detection, place: [f64; 3]) -> &Candidate {
    let place = camera_from_table() * Point3::from(place);
    let away = |candidate: &&Candidate| (candidate.oriented_box.centre() - place).norm();
    let nearest = detection
        .candidates
        .iter()
        .min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.expect("a candidate")
}

fn box_in_camera(solid: &BoxOnTable, shift_m: [f64; 3]) -> OrientedBox {
    let [x, y] = solid.centre;
    let middle = Vector3::new(x, y, solid.bottom + 0.5 * solid.sides[2]) + Vector3::from(shift_m);
    let upright = OrientedBox {
        frame_from_box: Isometry3::from_parts(middle.into(), nalgebra::UnitQuaternion::identity()),
        half_sides_m: 0.5 * Vector3::from(solid.sides),
    };
    upright.transformed(&camera_from_table())
}

fn capsule_in_camera(from: [f64; 3], to: [f64; 3], radius_m: f64) -> Capsule {
    let capsule = Capsule {
        from: from.into(),
        to: to.into(),
        radius_m,
    };
    capsule.transformed(&camera_from_table())
}

fn check(
    findings: &Findings,
    constraint: Constraint,
    truth: Ternary,
    is_reason: fn(Reason) -> bool,
) {
    let finding = findings.get(constraint);
    assert_eq!(finding.value, truth, "{constraint:?}: {}", finding.reason);
    assert!(is_reason(finding.reason), "{:?}", finding.reason);
}

#[test]
fn verdict_is_true_for_a_free_standing_object() {
    let detection = found_plainly(&[MIDDLE]);
    let candidate = near(&detection, [0.0, 0.0, 0.06]);
    assert_eq!(candidate.verdict, Ternary::True);
    let findings = &candidate.findings;
    check(findings, Constraint::Table, Ternary::True, |r| {
        r == Reason::StandsOnTable
    });
    check(findings, Constraint::Track, Ternary::True, |r| {
        r == Reason::NoOverlappingTrack { overlap: 0.0 }
    });
    check(findings, Constraint::Size, Ternary::True, |r| {
        matches!(r, Reason::Graspable { .. })
    });
    check(findings, Constraint::Edge, Ternary::False, |r| {
        r == Reason::AwayFromRim
    });
    check(findings, Constraint::Robot, Ternary::False, |r| {
        r == Reason::NoRobotKnown
    });
    check(findings, Constraint::Instructor, Ternary::False, |r| {
        r == Reason::NoPersonKnown
    });
    check(findings, Constraint::KeyView, Ternary::Unknown, |r| {
        r == Reason::KeyViewUndecided
    });
    check(findings, Constraint::ImageBorder, Ternary::False, |r| {
        r == Reason::WithinView
    });
}

#[test]
fn assumptions_name_the_absent_sources() {
    let points = render(&[MIDDLE], 1.0);
    let assumptions_of =
        |surroundings| found(&points, surroundings, &Config::default()).assumptions;
    let nothing_known = assumptions_of(ScenePriors::default());
    for assumption in [
        Assumption::NoPersonKnown,
        Assumption::NoRobotKnown,
        Assumption::UpGuessed,
    ] {
        assert!(nothing_known.contains(assumption));
    }
    let empty_scene = assumptions_of(ScenePriors {
        instructor: Some(&[]),
        robot: Some(&[]),
        surfaces: &[],
        tracks: &[],
        bodies: None,
        world_from_camera: RigidTransform::identity(),
    });
    assert_eq!(
        empty_scene.iter().collect::<Vec<_>>(),
        [Assumption::UpGuessed]
    );
}

/// Two boxes of one colour side by side look like one longer box.
#[test]
fn track_regrouping_splits_two_touching_tracked_objects() {
    let sides = [0.08, 0.08, 0.12];
    let pair = [box_at(-0.04, 0.0, sides), box_at(0.04, 0.0, sides)];
    let points = render(&pair, 1.0);
    let with = |tracks: &[ExpectedTrack]| {
        let surroundings = ScenePriors {
            tracks,
            ..ScenePriors::default()
        };
        found(&points, surroundings, &Config::default())
    };
    let whole = with(&[]);
    assert_eq!(whole.candidates.len(), 1);
    let n_points = whole.candidates[0].n_points() / 2;
    let track = |solid: &BoxOnTable, n_points: usize| ExpectedTrack {
        oriented_box: box_in_camera(solid, [0.004, 0.003, 0.0]),
        n_points,
        is_handled: false,
        colors: None,
    };
    let both = pair.each_ref().map(|solid| track(solid, n_points));
    let split = with(&both);
    assert_eq!(split.candidates.len(), 2);
    for solid in &pair {
        let [x, y] = solid.centre;
        let half = near(&split, [x, y, 0.06]);
        let middle = camera_from_table() * Point3::new(x, y, 0.06);
        assert!(
            (half.oriented_box.centre() - middle).norm() < 0.012,
            "{half:?}"
        );
        assert!(half.n_points() > n_points * 8 / 10);
    }
    // One track of the whole, two boxes that may be empty, two tracks of one object.
    let twice = box_at(0.0, 0.0, [0.16, 0.08, 0.12]);
    let unseen = pair.each_ref().map(|solid| track(solid, 0));
    for tracks in [
        vec![track(&twice, 2 * n_points)],
        unseen.to_vec(),
        vec![track(&twice, 2 * n_points); 2],
    ] {
        assert_eq!(with(&tracks).candidates.len(), 1);
    }
}

/// A hand over two boxes that touch leaves a part of each beside it, in the space of the hand.
#[test]
fn track_regrouping_splits_the_parts_of_two_objects_beside_a_hand() {
    let sides = [0.08, 0.08, 0.12];
    let pair = [box_at(-0.04, 0.0, sides), box_at(0.04, 0.0, sides)];
    let points = render(&pair, 1.0);
    let hand = [Capsule {
        from: camera_from_table() * Point3::new(-0.045, 0.0, 0.06),
        to: camera_from_table() * Point3::new(0.025, 0.0, 0.06),
        radius_m: 0.05,
    }];
    let table_from_camera = camera_from_table().inverse();
    let x_of = |pixel: &u32| (table_from_camera * points[*pixel as usize].position()).x;
    let n_across = |is_handled: bool| {
        let tracks = pair.each_ref().map(|solid| ExpectedTrack {
            oriented_box: box_in_camera(solid, [0.0; 3]),
            n_points: 100_000,
            is_handled,
            colors: None,
        });
        let surroundings = ScenePriors {
            tracks: &tracks,
            instructor: Some(&hand),
            ..ScenePriors::default()
        };
        let detection = found(&points, surroundings, &Config::default());
        let is_across = |candidate: &&Candidate| {
            let pixels = detection.points_of(candidate);
            let n_beyond = |sign: f64| pixels.iter().filter(move |pixel| sign * x_of(pixel) > 0.01);
            [-1.0, 1.0].iter().all(|sign| n_beyond(*sign).count() > 20)
        };
        detection.candidates.iter().filter(is_across).count()
    };
    // The share of such large tracks does not count unless a hand may hide the rest.
    assert_eq!([false, true].map(n_across), [3, 0]);
}

#[test]
fn track_constraint_is_false_for_an_explained_candidate() {
    let points = render(&[MIDDLE], 1.0);
    let evaluated = |boxes: &[OrientedBox]| {
        let tracks: Vec<ExpectedTrack> = boxes.iter().map(|shape| (*shape).into()).collect();
        let surroundings = ScenePriors {
            tracks: &tracks,
            ..ScenePriors::default()
        };
        let detection = found(&points, surroundings, &Config::default());
        near(&detection, [0.0, 0.0, 0.06]).clone()
    };
    let same = evaluated(&[box_in_camera(&MIDDLE, [0.01, 0.0, 0.0])]);
    check(
        &same.findings,
        Constraint::Track,
        Ternary::False,
        |r| matches!(r, Reason::OverlapsTrack { overlap } if overlap > 0.6),
    );
    assert_eq!(same.verdict, Ternary::False);
    assert_eq!(
        same.decisive.iter().collect::<Vec<_>>(),
        [Constraint::Track]
    );
    // A track of a much larger object around it.
    let larger = BoxOnTable {
        sides: [0.3, 0.3, 0.3],
        ..MIDDLE
    };
    let inside = evaluated(&[box_in_camera(&larger, [0.0; 3])]);
    check(
        &inside.findings,
        Constraint::Track,
        Ternary::False,
        |r| matches!(r, Reason::InsideTrack { share } if share > 0.95),
    );
    let beside = evaluated(&[box_in_camera(&MIDDLE, [0.2, 0.0, 0.0])]);
    check(
        &beside.findings,
        Constraint::Track,
        Ternary::True,
        |r| matches!(r, Reason::NoOverlappingTrack { overlap } if overlap == 0.0),
    );
    assert_eq!(beside.verdict, Ternary::True);
    let broken = evaluated(&[OrientedBox {
        half_sides_m: Vector3::repeat(f64::NAN),
        ..box_in_camera(&MIDDLE, [0.0; 3])
    }]);
    assert_eq!(broken.verdict, Ternary::True);
}

#[test]
fn size_constraint_names_the_violated_limit() {
    let evaluated = |sides: [f64; 3]| {
        let detection = found_plainly(&[box_at(0.0, 0.05, sides)]);
        near(&detection, [0.0, 0.05, 0.5 * sides[2]]).clone()
    };
    let long = evaluated([0.45, 0.06, 0.06]);
    check(
        &long.findings,
        Constraint::Size,
        Ternary::False,
        |r| matches!(r, Reason::TooLong { side_m, max_m } if (side_m - 0.45).abs() < 0.02 && max_m == 0.35),
    );
    // The default rule does not include C_size.
    assert_eq!(long.verdict, Ternary::True);
    let broad = evaluated([0.30, 0.29, 0.05]);
    check(
        &broad.findings,
        Constraint::Size,
        Ternary::False,
        |r| matches!(r, Reason::TooBroad { side_m, .. } if (side_m - 0.29).abs() < 0.02),
    );
    let bulky = evaluated([0.34, 0.24, 0.24]);
    check(
        &bulky.findings,
        Constraint::Size,
        Ternary::False,
        |r| matches!(r, Reason::TooBulky { volume_m3, .. } if (volume_m3 - 0.0196).abs() < 0.003),
    );
    let config = Config::new(RawConfig {
        side_max_m: 0.4,
        ..RawConfig::default()
    });
    let points = render(&[box_at(0.0, 0.05, [0.45, 0.06, 0.06])], 1.0);
    let detection = found(&points, ScenePriors::default(), &config.unwrap());
    let no_object = near(&detection, [0.0, 0.05, 0.03]);
    assert!(!no_object.is_object_sized && !no_object.can_continue_track());
    assert_eq!(no_object.verdict, Ternary::False);
    assert_eq!(
        no_object.decisive.iter().collect::<Vec<_>>(),
        [Constraint::Size]
    );
    check(
        &no_object.findings,
        Constraint::Size,
        Ternary::False,
        |r| matches!(r, Reason::TooLong { max_m, .. } if max_m == 0.4),
    );
}

#[test]
fn size_constraint_is_unknown_at_the_image_border() {
    let detection = found_plainly(&[box_at(-0.47, 0.0, [0.12, 0.1, 0.2])]);
    let cut = near(&detection, [-0.47, 0.0, 0.1]);
    check(&cut.findings, Constraint::Size, Ternary::Unknown, |r| {
        matches!(r, Reason::SizeTruncated { .. })
    });
    check(&cut.findings, Constraint::ImageBorder, Ternary::True, |r| {
        r == Reason::AtImageBorder
    });
}

#[test]
fn edge_constraint_rejects_an_object_at_the_rim() {
    // The far rim is fully visible, at y = 0.4.
    let evaluated = |y: f64| {
        let detection = found_plainly(&[box_at(0.0, y, [0.1, 0.05, 0.03])]);
        near(&detection, [0.0, y, 0.015]).clone()
    };
    let at_rim = evaluated(0.365);
    check(
        &at_rim.findings,
        Constraint::Edge,
        Ternary::True,
        |r| matches!(r, Reason::AtRim { share, distance_m } if share > 0.3 && distance_m == 0.03),
    );
    // The default rule accepts it; the paper's does not.
    assert_eq!(at_rim.verdict, Ternary::True);
    let paper = Expression::paper();
    assert_eq!(paper.evaluate(&at_rim.findings), Ternary::False);
    check(
        &evaluated(0.25).findings,
        Constraint::Edge,
        Ternary::False,
        |r| r == Reason::AwayFromRim,
    );
}

#[test]
fn robot_constraint_rejects_a_robot_link() {
    let points = render(
        &[
            box_at(-0.2, 0.0, [0.3, 0.04, 0.05]),
            box_at(0.2, 0.0, [0.1; 3]),
        ],
        1.0,
    );
    let link = [capsule_in_camera([-0.4, 0.0, 0.02], [0.0, 0.0, 0.02], 0.03)];
    let evaluated = |surroundings| found(&points, surroundings, &Config::default());
    let as_robot = evaluated(ScenePriors {
        robot: Some(&link),
        instructor: Some(&[]),
        ..ScenePriors::default()
    });
    let arm = near(&as_robot, [-0.2, 0.0, 0.025]);
    check(
        &arm.findings,
        Constraint::Robot,
        Ternary::True,
        |r| matches!(r, Reason::Robot { share, margin_m } if share == 1.0 && margin_m == 0.03),
    );
    check(&arm.findings, Constraint::Instructor, Ternary::False, |r| {
        r == Reason::NotPerson
    });
    assert_eq!(arm.verdict, Ternary::False);
    assert_eq!(arm.decisive.iter().collect::<Vec<_>>(), [Constraint::Robot]);
    assert!(!arm.can_continue_track() && !arm.is_hypothesis());
    let other = near(&as_robot, [0.2, 0.0, 0.05]);
    check(&other.findings, Constraint::Robot, Ternary::False, |r| {
        r == Reason::NotRobot
    });
    assert_eq!(other.verdict, Ternary::True);
    let as_person = evaluated(ScenePriors {
        instructor: Some(&link),
        ..ScenePriors::default()
    });
    let hand = near(&as_person, [-0.2, 0.0, 0.025]);
    check(
        &hand.findings,
        Constraint::Instructor,
        Ternary::True,
        |r| matches!(r, Reason::Person { margin_m, .. } if margin_m == 0.05),
    );
    check(&hand.findings, Constraint::Robot, Ternary::False, |r| {
        r == Reason::NoRobotKnown
    });
}

#[test]
fn body_constraints_are_independent_where_person_and_robot_meet() {
    let points = render(&[box_at(0.0, 0.0, [0.4, 0.05, 0.05])], 1.0);
    // One fifth belongs only to the robot, the rest to the person.
    let robot = [capsule_in_camera(
        [-0.2, 0.0, 0.025],
        [-0.15, 0.0, 0.025],
        0.04,
    )];
    let person = [capsule_in_camera(
        [-0.07, 0.0, 0.025],
        [0.25, 0.0, 0.025],
        0.04,
    )];
    let surroundings = ScenePriors {
        robot: Some(&robot),
        instructor: Some(&person),
        surfaces: &[],
        tracks: &[],
        bodies: None,
        world_from_camera: RigidTransform::identity(),
    };
    let detection = found(&points, surroundings, &Config::default());
    let both = near(&detection, [0.0, 0.0, 0.025]);
    check(
        &both.findings,
        Constraint::Robot,
        Ternary::Unknown,
        |r| matches!(r, Reason::MaybeRobot { share, .. } if (0.1..0.5).contains(&share)),
    );
    check(
        &both.findings,
        Constraint::Instructor,
        Ternary::True,
        |_| true,
    );
}

#[test]
fn body_mask_separates_a_hand_from_the_object_it_touches() {
    // A beam through a box, like an arm over a carton: one connected surface.
    let carton = box_at(0.0, 0.0, [0.12, 0.12, 0.14]);
    let forearm = BoxOnTable {
        centre: [0.2, -0.03],
        bottom: 0.06,
        sides: [0.36, 0.05, 0.05],
        rgb: [30, 200, 30],
    };
    let points = render(&[carton, forearm], 1.0);
    let merged = found(&points, ScenePriors::default(), &Config::default());
    let capsule = [capsule_in_camera(
        [0.08, -0.03, 0.085],
        [0.40, -0.03, 0.085],
        0.03,
    )];
    let surroundings = ScenePriors {
        instructor: Some(&capsule),
        ..ScenePriors::default()
    };
    let config = Config::new(RawConfig {
        person_margin_m: 0.01,
        ..RawConfig::default()
    });
    let detection = found(&points, surroundings, &config.unwrap());
    let is_person = |c: &&Candidate| c.findings.is_person_or_robot();
    let (limbs, objects): (Vec<_>, Vec<_>) = detection.candidates.iter().partition(is_person);
    assert!(!limbs.is_empty() && limbs.iter().all(|limb| limb.verdict == Ternary::False));
    let green = |candidate: &Candidate| candidate.mean_rgb[1];
    assert!(limbs.iter().all(|limb| green(limb) > 150.0), "{limbs:?}");
    let kept = objects
        .iter()
        .filter(|c| c.is_hypothesis())
        .collect::<Vec<_>>();
    assert_eq!(kept.len(), 1, "{objects:?}");
    assert!(green(kept[0]) < 50.0, "{:?}", kept[0].mean_rgb);
    // A touched object begins no track: a part of it may be missing.
    check(
        &kept[0].findings,
        Constraint::Instructor,
        Ternary::Unknown,
        |r| matches!(r, Reason::TouchedByPerson { share, .. } if share > 0.05),
    );
    assert_eq!(kept[0].verdict, Ternary::Unknown);
    assert!(kept[0].can_continue_track() && kept[0].is_touched());
    let sides = kept[0].oriented_box.sides_m();
    assert!(
        (sides - Vector3::new(0.12, 0.12, 0.14)).amax() < 0.03,
        "{sides}"
    );
    // Without the capsule, box and beam are separated worse or not at all.
    let n_points_in_box = |detection: &Detection| near(detection, [0.0, 0.0, 0.07]).n_points();
    assert!(n_points_in_box(&merged) >= n_points_in_box(&detection));
    let mut indices = detection.point_indices.clone();
    indices.sort_unstable();
    indices.dedup();
    assert_eq!(indices.len(), detection.point_indices.len());
}

#[test]
fn table_constraint_is_unknown_without_depth_below() {
    // A plate 0.2 m over the table, with and without a strip without depth below it.
    let mut points = render(&[], 0.0);
    let camera_from_table = camera_from_table();
    let eye = camera_from_table.inverse() * Point3::origin();
    for row in 200..240 {
        for point in &mut points[row * 640 + 250..row * 640 + 400] {
            let on_table = camera_from_table.inverse() * point.position();
            let share = (0.2 - eye.z) / (on_table.z - eye.z);
            let at = camera_from_table * (eye + (on_table - eye) * share);
            (point.x, point.y, point.z) = (at.x as f32, at.y as f32, at.z as f32);
        }
    }
    let plate = |points: &[Point]| {
        let detection = found(points, ScenePriors::default(), &Config::default());
        assert_eq!(detection.candidates.len(), 1, "{:?}", detection.candidates);
        detection.candidates[0].clone()
    };
    let in_the_air = plate(&points);
    check(
        &in_the_air.findings,
        Constraint::Table,
        Ternary::False,
        |r| matches!(r, Reason::Unsupported { gap_m } if (gap_m - 0.2).abs() < 0.01),
    );
    for row in 240..255 {
        for point in &mut points[row * 640 + 240..row * 640 + 410] {
            *point = Point::without_depth(point.color);
        }
    }
    let unseen = plate(&points);
    check(&unseen.findings, Constraint::Table, Ternary::Unknown, |r| {
        r == Reason::BaseWithoutDepth
    });
    assert_eq!(unseen.verdict, Ternary::Unknown);
    assert!(unseen.decisive.contains(Constraint::Table));
    assert!(unseen.can_continue_track());
}

#[test]
fn rule_of_the_settings_decides_the_verdict() {
    let points = render(&[box_at(-0.47, 0.0, [0.12, 0.1, 0.2]), MIDDLE], 1.0);
    let verdicts = |rule: &str| {
        let raw = RawConfig {
            rule: rule.into(),
            ..RawConfig::default()
        };
        let detection = found(&points, ScenePriors::default(), &Config::new(raw).unwrap());
        let at = |place| near(&detection, place).verdict;
        [at([-0.47, 0.0, 0.1]), at([0.0, 0.0, 0.06])]
    };
    assert_eq!(verdicts("C_table"), [Ternary::True; 2]);
    assert_eq!(
        verdicts("C_table and not C_image_border"),
        [Ternary::False, Ternary::True]
    );
    assert_eq!(
        verdicts("C_table and C_size"),
        [Ternary::Unknown, Ternary::True]
    );
    assert_eq!(verdicts("C_key_view or C_table"), [Ternary::True; 2]);
    assert_eq!(verdicts("C_key_view"), [Ternary::Unknown; 2]);
}

#[test]
fn body_mask_ignores_non_finite_capsules() {
    let points = render(&[MIDDLE], 1.0);
    let capsules: Vec<Capsule> = [f64::NAN, f64::INFINITY, -1.0, 1e300]
        .into_iter()
        .map(|radius_m| Capsule {
            from: Point3::new(f64::NAN, 0.0, 1.0),
            to: Point3::new(FRAC_PI_4, f64::INFINITY, 1.0),
            radius_m,
        })
        .collect();
    let surroundings = ScenePriors {
        robot: Some(&capsules),
        instructor: Some(&capsules),
        surfaces: &[],
        tracks: &[],
        bodies: None,
        world_from_camera: RigidTransform::identity(),
    };
    let detection = found(&points, surroundings, &Config::default());
    assert_eq!(near(&detection, [0.0, 0.0, 0.06]).verdict, Ternary::True);
}
