//! Table selection in views with one plane or none.

use crate::detection_outcome::DetectionOutcome;
use crate::synthetic_scene::{FLOOR, OBJECT, PlacedShape, SyntheticScene, TABLE};
use crate::{HIGH, objects, on_table, room, table, view};
use detection::TableChoice;
use nalgebra::Vector3;

#[test]
fn a_wall_is_no_table() {
    for eye_z in [1.0, 1.6] {
        let scene = SyntheticScene::seen_from([0.0, -1.0, eye_z], [0.0, 0.0, 0.5])
            .with([PlacedShape::wall(0.2)]);
        for outcome in DetectionOutcome::both(&scene) {
            assert!(
                outcome.detection.surfaces.is_empty(),
                "{:?}",
                outcome.detection.surfaces
            );
        }
    }
}

#[test]
fn a_wall_before_a_level_camera_needs_known_up() {
    let scene =
        SyntheticScene::seen_from([0.0, -1.0, 1.0], [0.0, 0.0, 1.0]).with([PlacedShape::wall(0.2)]);
    let [without, with] = DetectionOutcome::both(&scene);
    // With unknown up, this looks like a table seen from above.
    assert!(!without.detection.surfaces.is_empty());
    assert!(with.detection.surfaces.is_empty());
}

#[test]
fn the_floor_carries_objects_where_there_is_no_table() {
    let cuboid = |x: f64, n: u16| PlacedShape::cuboid([0.15, 0.1, 0.2], [x, 0.0, 0.0], OBJECT + n);
    let scene = SyntheticScene::seen_from([0.0, -0.9, 1.2], [0.0, 0.0, 0.0]);
    let scene = scene.with([PlacedShape::floor(), cuboid(-0.25, 0), cuboid(0.2, 1)]);
    for outcome in DetectionOutcome::both(&scene) {
        outcome.assert_objects(&objects(2), 0.9);
        assert_eq!(outcome.table().choice, TableChoice::Most);
        assert!(outcome.table_height_m([0.0, 0.0]).abs() < 0.003);
    }
}

#[test]
fn a_table_is_found_at_a_grazing_view_and_from_above() {
    let grazing = 15_f64.to_radians();
    let (far, high) = (grazing.cos(), grazing.sin());
    for (eye, target) in [
        ([0.0, -far, HIGH + high], [0.0, 0.0, HIGH]),
        ([0.0, 0.0, HIGH + 1.0], [0.0, 0.0, HIGH]),
        ([0.05, -0.1, HIGH + 0.9], [0.0, 0.0, HIGH]),
        ([0.05, -0.4, HIGH + 0.8], [0.0, 0.0, HIGH]),
    ] {
        let solids = [
            table(),
            on_table([0.1, 0.08, 0.12], [-0.1, 0.0], 0).turned(20.0),
            PlacedShape::floor(),
        ];
        let scene = SyntheticScene::seen_from(eye, target).with(solids);
        for outcome in DetectionOutcome::both(&scene) {
            assert!(
                (outcome.table_height_m([0.0, 0.0]) - HIGH).abs() < 0.003,
                "{eye:?}"
            );
            if eye[1] != 0.0 {
                outcome.assert_objects(&objects(1), 0.9);
            }
        }
    }
}

#[test]
fn a_box_seen_from_straight_above_is_an_object() {
    let solids = [
        table(),
        on_table([0.1, 0.08, 0.12], [0.0, 0.0], 0),
        PlacedShape::floor(),
    ];
    let scene = SyntheticScene::seen_from([0.0, 0.0, HIGH + 1.0], [0.0, 0.0, HIGH]).with(solids);
    for outcome in DetectionOutcome::both(&scene) {
        outcome.assert_objects(&objects(1), 0.9);
    }
}

#[test]
fn a_tilted_plane_is_no_table_where_up_is_known() {
    for axis in [Vector3::x_axis(), Vector3::y_axis()] {
        for (deg, is_table) in [(0.0, true), (8.0, true), (20.0, false), (-20.0, false)] {
            let scene = view().with([table().tilted(axis, deg)]);
            let [_, with] = DetectionOutcome::both(&scene);
            assert_eq!(!with.detection.surfaces.is_empty(), is_table, "{deg}");
        }
    }
}

#[test]
fn a_tilted_plane_gives_way_to_the_level_floor_under_it() {
    let scene = view().with([
        table().tilted(Vector3::x_axis(), 25.0),
        PlacedShape::floor(),
    ]);
    let [_, with] = DetectionOutcome::both(&scene);
    assert!(
        with.detection
            .table()
            .is_none_or(|_| with.table_height_m([0.0, 0.0]).abs() < 0.02)
    );
}

#[test]
fn an_empty_table_has_no_objects() {
    for (noise_m, is_stepped) in [(0.0, false), (0.001, false), (0.002, false), (0.0007, true)] {
        let mut scene = room();
        (scene.noise_m, scene.is_stepped) = (noise_m, is_stepped);
        for outcome in DetectionOutcome::both(&scene) {
            outcome.assert_objects(&[], 1.0);
        }
    }
}

#[test]
fn floor_around_the_table_is_not_selected() {
    for sides in [[0.8, 0.6], [0.45, 0.4]] {
        let solids = [
            PlacedShape::rectangle(sides, HIGH, TABLE),
            PlacedShape::floor(),
            on_table([0.1, 0.08, 0.12], [0.05, 0.0], 0),
        ];
        let scene =
            SyntheticScene::seen_from([0.0, -0.9, HIGH + 0.75], [0.0, 0.0, HIGH]).with(solids);
        for outcome in DetectionOutcome::both(&scene) {
            let share = |what: u16| {
                outcome.truth.iter().filter(|&&there| there == what).count() as f64 / 307_200.0
            };
            assert!(
                share(FLOOR) > share(TABLE),
                "{} {}",
                share(FLOOR),
                share(TABLE)
            );
            assert!(
                (outcome.table_height_m([0.0, 0.0]) - HIGH).abs() < 0.003,
                "{}",
                share(TABLE)
            );
            outcome.assert_objects(&objects(1), 0.9);
            assert!(outcome.table().outline.is_rim.iter().all(|&is_rim| is_rim));
        }
    }
}

#[test]
fn occluded_table_is_found_around_a_large_box() {
    // The top of the box is a larger plane than the visible rest of the table.
    for sides in [[0.72, 0.53, 0.03], [0.62, 0.46, 0.06], [0.5, 0.4, 0.10]] {
        for outcome in DetectionOutcome::both(&room().with([on_table(sides, [0.0, 0.0], 0)])) {
            let height_m = outcome.table_height_m([0.0, 0.0]);
            assert!((height_m - HIGH).abs() < 0.004, "{height_m} {sides:?}");
            let is_around = outcome.table().choice == TableChoice::Around;
            assert!(is_around || sides[0] < 0.7, "{}", outcome.table().choice);
            outcome.assert_objects(&objects(1), 0.9);
        }
    }
}

#[test]
fn box_that_occludes_the_table_is_selected_as_table() {
    let scene = room().with([on_table([0.82, 0.62, 0.12], [0.0, 0.0], 0)]);
    for outcome in DetectionOutcome::both(&scene) {
        assert!((outcome.table_height_m([0.0, 0.0]) - HIGH - 0.12).abs() < 0.003);
        outcome.assert_objects(&[], 1.0);
    }
}

/// Close view of a table that fills the image but for a strip of floor behind it.
fn close_view() -> SyntheticScene {
    let table = PlacedShape::rectangle([1.8, 1.0], HIGH, TABLE);
    SyntheticScene::seen_from([0.0, -0.55, HIGH + 0.45], [0.0, 0.0, HIGH])
        .with([table, PlacedShape::floor()])
}

#[test]
fn occluded_table_is_found_under_a_book_cut_by_the_image() {
    for (sides, x) in [
        ([0.55, 0.75, 0.015], 0.0),
        ([0.6, 0.7, 0.03], 0.05),
        ([0.65, 0.6, 0.06], -0.05),
    ] {
        for outcome in DetectionOutcome::both(&close_view().with([on_table(sides, [x, -0.2], 0)])) {
            for place in [[0.0, 0.0], [-0.4, 0.3], [0.4, 0.3], [0.0, -0.3]] {
                let error_m = outcome.table_height_m(place) - HIGH;
                assert!(error_m.abs() < 0.004, "{error_m} {sides:?} {place:?}");
            }
            assert_eq!(outcome.table().choice, TableChoice::Around, "{sides:?}");
        }
    }
}

#[test]
fn occluded_table_is_found_under_a_leaning_book() {
    for deg in [3.0_f64, 6.0, 10.0] {
        // The near edge lies on the table.
        let rise_m = 0.25 * deg.to_radians().sin() + 0.001;
        let book = PlacedShape::cuboid([0.7, 0.5, 0.02], [0.0, -0.1, HIGH + rise_m], OBJECT)
            .tilted(Vector3::x_axis(), deg);
        for outcome in DetectionOutcome::both(&close_view().with([book])) {
            for place in [[0.0, 0.0], [-0.4, 0.3], [0.4, 0.3], [0.0, -0.3]] {
                let error_m = outcome.table_height_m(place) - HIGH;
                assert!(error_m.abs() < 0.004, "{error_m} {deg} {place:?}");
            }
        }
    }
}

#[test]
fn a_table_over_a_bench_is_no_top_of_an_object() {
    // The bench is in view along one side of the table; beside the others is the floor.
    for low_m in [0.1, 0.2, 0.3] {
        let sides = [0.7, 0.3, HIGH - low_m];
        let bench = PlacedShape::cuboid(sides, [0.0, 0.42, 0.0], OBJECT);
        let table = PlacedShape::rectangle([0.7, 0.5], HIGH, TABLE);
        let scene = view().with([table, bench, PlacedShape::floor()]);
        for outcome in DetectionOutcome::both(&scene) {
            let error_m = outcome.table_height_m([0.0, 0.0]) - HIGH;
            assert!(error_m.abs() < 0.003, "{error_m} {low_m}");
        }
    }
}
