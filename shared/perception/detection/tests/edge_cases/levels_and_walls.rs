//! Boards of a shelf, which carry objects each, and walls, which are no objects.

use crate::detection_outcome::DetectionOutcome;
use crate::synthetic_scene::{OBJECT, PlacedShape, SyntheticScene, TABLE};
use crate::{HIGH, on_table, room, view};
use detection::{ScenePriors, SurfaceRole, TableChoice};
use geometry::{Capsule, Plane};
use nalgebra::Point3;

/// Height of the lower board, metres.
const LOWER: f64 = HIGH - 0.35;

/// Board of a shelf with its upper side at a height.
fn board(depth_m: f64, y: f64, z: f64) -> PlacedShape {
    PlacedShape::cuboid([0.8, depth_m, 0.02], [0.0, y, z - 0.02], TABLE)
}

/// Shelf with two boards, of which the lower one is deeper, three objects on the upper one and two
/// on the lower one, and a back; seen at an angle over the horizon.
fn shelf(elevation_deg: f64) -> SyntheticScene {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let eye = [0.0, 0.1 - 1.2 * cos, HIGH - 0.15 + 1.2 * sin];
    let upper = [-0.25, 0.0, 0.25].map(|x| [x, 0.3, HIGH]);
    let lower = [-0.2, 0.2].map(|x| [x, -0.1, LOWER]);
    let places = upper.into_iter().chain(lower);
    let objects = places
        .zip(OBJECT..)
        .map(|(place, label)| PlacedShape::cuboid([0.08, 0.08, 0.14], place, label));
    let back = PlacedShape::cuboid([0.8, 0.02, 1.0], [0.0, 0.47, LOWER - 0.1], TABLE);
    SyntheticScene::seen_from(eye, [0.0, 0.1, HIGH - 0.15])
        .with([board(0.3, 0.3, HIGH), board(0.7, 0.1, LOWER), back])
        .with(objects)
}

fn roles(outcome: &DetectionOutcome) -> Vec<SurfaceRole> {
    let surfaces = outcome.detection.surfaces.iter();
    surfaces.map(|surface| surface.role).collect()
}

#[test]
fn objects_on_both_boards_of_a_shelf_are_found_and_nothing_else() {
    for elevation_deg in [25.0, 35.0, 45.0, 60.0] {
        for outcome in DetectionOutcome::both(&shelf(elevation_deg)) {
            assert_eq!(
                roles(&outcome),
                [SurfaceRole::Table, SurfaceRole::Level],
                "{elevation_deg}"
            );
            let objects: Vec<u16> = (OBJECT..OBJECT + 5).collect();
            outcome.assert_objects(&objects, 0.75);
            // Each candidate is told with the board that carries it.
            let board_of = |object: u16| {
                let candidate = &outcome.detection.candidates[outcome.best(object).0];
                candidate.surface
            };
            let upper = board_of(OBJECT);
            assert_eq!([1, 2].map(|n| board_of(OBJECT + n)), [upper; 2]);
            assert_eq!([3, 4].map(|n| board_of(OBJECT + n)), [1 - upper; 2]);
        }
    }
}

/// Shelf with three boards, two sides and a back, with an object on each board; seen at an angle
/// over the horizon and from the left or the right.
fn shelf_with_sides(elevation_deg: f64, eye_x: f64) -> SyntheticScene {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let (y, gap, middle) = (0.3, 0.34, HIGH - 0.34);
    let eye = [eye_x, y - 1.5 * cos, middle + 1.5 * sin];
    let boards = [0.0, 1.0, 2.0].map(|n| board(0.42, y, HIGH - n * gap));
    let (low, tall) = (middle - gap - 0.02, 2.0 * gap + 0.02);
    let side = |x: f64| PlacedShape::cuboid([0.02, 0.42, tall], [x, y, low], TABLE);
    let back = PlacedShape::cuboid([0.84, 0.02, tall], [0.0, y + 0.22, low], TABLE);
    let objects = [-0.15, 0.1, 0.0].into_iter().zip(OBJECT..);
    let objects = objects.map(|(x, label)| {
        let z = HIGH - f64::from(label - OBJECT) * gap;
        PlacedShape::cuboid([0.08, 0.08, 0.12], [x, y - 0.1, z], label)
    });
    SyntheticScene::seen_from(eye, [0.0, y, middle])
        .with(boards)
        .with([side(-0.41), side(0.41), back])
        .with(objects)
}

#[test]
fn lowest_board_and_sides_of_a_shelf_are_furniture() {
    for (elevation_deg, eye_x) in [(25.0, 0.0), (30.0, 0.3), (45.0, 0.0)] {
        let outcome = DetectionOutcome::of(&shelf_with_sides(elevation_deg, eye_x));
        let carriers = roles(&outcome);
        let carriers = carriers.into_iter().filter(|role| role.carries_objects());
        assert_eq!(carriers.count(), 3, "{elevation_deg} {eye_x}");
        let found = (OBJECT..OBJECT + 3).map(|object| outcome.best(object).1);
        assert!(found.into_iter().all(|overlap| overlap >= 0.9));
        // A sliver of a side may be left.
        let candidates = outcome.detection.candidates.iter();
        let n_large = candidates.filter(|one| one.n_points() > 300).count();
        assert_eq!(n_large, 3, "{elevation_deg} {eye_x}");
    }
}

#[test]
fn two_objects_in_one_plane_are_no_wall() {
    // Their far faces are in the plane of the far rim of the table.
    let at_rim = [-0.4, 0.4].map(|x| on_table([0.16, 0.1, 0.2], [x, 0.32], u16::from(x > 0.0)));
    for outcome in DetectionOutcome::both(&room().with(at_rim)) {
        outcome.assert_objects(&[OBJECT, OBJECT + 1], 0.8);
    }
}

#[test]
fn top_of_a_large_box_is_no_level() {
    let large = on_table([0.55, 0.3, 0.2], [0.0, 0.1], 0);
    let on_top = PlacedShape::cuboid([0.08, 0.08, 0.1], [0.1, 0.1, HIGH + 0.2], OBJECT + 1);
    for outcome in DetectionOutcome::both(&room().with([large, on_top])) {
        let carriers = roles(&outcome);
        let carriers = carriers.into_iter().filter(|role| role.carries_objects());
        assert_eq!(carriers.count(), 1);
        assert!(outcome.best(OBJECT + 1).1 > 0.8);
    }
}

#[test]
fn floor_under_a_table_is_listed_and_carries_nothing() {
    let eye = [0.0, -1.0, HIGH + 0.7];
    let scene = SyntheticScene::seen_from(eye, [0.0, 0.0, HIGH]).with([
        PlacedShape::rectangle([0.5, 0.4], HIGH, TABLE),
        PlacedShape::floor(),
        on_table([0.1; 3], [0.0; 2], 0),
    ]);
    for outcome in DetectionOutcome::both(&scene) {
        assert_eq!(roles(&outcome), [SurfaceRole::Table, SurfaceRole::Floor]);
        outcome.assert_objects(&[OBJECT], 0.85);
    }
}

#[test]
fn level_waits_for_earlier_frames_and_stays_with_them() {
    let scene = shelf(25.0);
    let alone = DetectionOutcome::of(&scene);
    let planes: Vec<Plane> = alone
        .detection
        .surfaces
        .iter()
        .map(|one| one.plane)
        .collect();
    let expecting = |surfaces| {
        let priors = ScenePriors {
            surfaces,
            ..ScenePriors::default()
        };
        DetectionOutcome::with_priors(&scene, priors)
    };
    let table_only = expecting(&planes[..1]);
    assert_eq!(roles(&table_only)[1], SurfaceRole::NewLevel);
    let both = expecting(&planes);
    assert_eq!(roles(&both)[1], SurfaceRole::Level);
    assert_eq!(both.detection.surfaces[1].choice, TableChoice::Level);
}

#[test]
fn wall_behind_the_table_is_no_object_and_what_stands_before_it_is() {
    let before = on_table([0.2, 0.06, 0.25], [0.1, 0.2], 0);
    let wall = PlacedShape::cuboid([2.0, 0.02, 2.0], [0.0, 0.31, HIGH - 1.0], TABLE);
    for outcome in DetectionOutcome::both(&room().with([before.clone(), wall])) {
        outcome.assert_objects(&[OBJECT], 0.85);
    }
    // Without the wall the box at the far border is an object, too.
    for outcome in DetectionOutcome::both(&room().with([before])) {
        outcome.assert_objects(&[OBJECT], 0.85);
    }
}

#[test]
fn face_of_a_box_at_the_far_rim_is_no_wall() {
    for sides in [[0.3, 0.05, 0.3], [0.25, 0.2, 0.35]] {
        let at_rim = on_table(sides, [0.0, 0.29 - 0.5 * sides[1]], 0);
        let scene = view().with([crate::table(), PlacedShape::floor(), at_rim]);
        for outcome in DetectionOutcome::both(&scene) {
            outcome.assert_objects(&[OBJECT], 0.85);
        }
    }
}

#[test]
fn robot_over_one_board_is_masked_there_alone() {
    // A link of the robot in the place of the middle object of the upper board.
    let scene = shelf(35.0);
    let link_in_world = [0.0, 0.12].map(|z| Point3::new(0.0, 0.3, HIGH + z));
    let link = Capsule {
        from: scene.camera_from_world * link_in_world[0],
        to: scene.camera_from_world * link_in_world[1],
        radius_m: 0.06,
    };
    let priors = ScenePriors {
        robot: Some(&[link]),
        ..ScenePriors::default()
    };
    let outcome = DetectionOutcome::with_priors(&scene, priors);
    let is_robot = |object: u16| {
        let candidate = &outcome.detection.candidates[outcome.best(object).0];
        candidate.findings.is_person_or_robot()
    };
    let robots: Vec<bool> = (OBJECT..OBJECT + 5).map(is_robot).collect();
    assert_eq!(robots, [false, true, false, false, false]);
}
