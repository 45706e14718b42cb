//! Table outline: concave, convex, cut by the image.

use crate::detection_outcome::DetectionOutcome;
use crate::synthetic_scene::{FLOOR, OBJECT, PlacedShape, SyntheticScene, TABLE};
use crate::{HIGH, objects, on_table, room, view};
use nalgebra::Point2;

/// L-shaped test table without its far right quarter.
const L_CORNERS: [[f64; 2]; 6] = [
    [-0.4, -0.35],
    [0.4, -0.35],
    [0.4, 0.0],
    [0.0, 0.0],
    [0.0, 0.35],
    [-0.4, 0.35],
];
const L_AREA_M2: f64 = 0.56 - 0.14;

/// Height of a floor in range, metres.
const NEAR_FLOOR: f64 = HIGH - 0.38;

fn l_room() -> SyntheticScene {
    SyntheticScene::seen_from([0.0, -0.8, HIGH + 0.7], [0.0, 0.0, HIGH]).with([
        PlacedShape::polygon(&L_CORNERS, HIGH, TABLE),
        PlacedShape::rectangle([8.0, 8.0], NEAR_FLOOR, FLOOR),
    ])
}

#[test]
fn an_l_shaped_table_has_a_concave_outline() {
    for outcome in DetectionOutcome::both(&l_room()) {
        let outline = &outcome.table().outline;
        let error = outcome.outline_m2() / L_AREA_M2 - 1.0;
        assert!(
            error.abs() < 0.05,
            "{error} {} corners",
            outline.corners.len()
        );
        let missing = [[0.04, 0.04], [0.41, 0.04], [0.41, 0.36], [0.04, 0.36]];
        for corner in &outline.corners {
            let quarter = missing.map(|[x, y]| outcome.on_table([x, y, HIGH]));
            let sides = quarter.iter().zip(quarter.iter().cycle().skip(1));
            let turns = sides.map(|(a, b)| (b - a).perp(&(corner - a)));
            assert!(
                !turns
                    .map(|turn| turn > 0.0)
                    .reduce(|a, b| a && b)
                    .unwrap_or(true),
                "{corner}"
            );
        }
        assert!(outline.is_rim.iter().all(|&is_rim| is_rim));
        for (place, rim_m) in [
            ([0.2, -0.1], 0.1),
            ([-0.1, 0.1], 0.1),
            ([0.1, 0.1], -0.1),
            ([0.15, 0.1], -0.1),
            ([-0.05, -0.05], 0.07),
        ] {
            let found_m = outcome
                .table()
                .rim_distance_m(&outcome.on_table([place[0], place[1], HIGH]));
            assert!(
                (found_m - rim_m).abs() < 0.03,
                "{place:?}: {found_m} for {rim_m}"
            );
        }
    }
}

#[test]
fn an_l_shaped_table_over_a_far_floor_has_a_concave_outline() {
    let scene = SyntheticScene::seen_from([0.0, -0.8, HIGH + 0.7], [0.0, 0.0, HIGH]).with([
        PlacedShape::polygon(&L_CORNERS, HIGH, TABLE),
        PlacedShape::floor(),
    ]);
    let outcome = DetectionOutcome::of(&scene);
    let error = outcome.outline_m2() / L_AREA_M2 - 1.0;
    assert!(error.abs() < 0.05, "{error}");
}

#[test]
fn objects_on_both_legs_of_an_l_are_found() {
    let solids = [
        on_table([0.1, 0.08, 0.12], [0.3, -0.18], 0),
        on_table([0.08, 0.1, 0.12], [-0.2, 0.2], 1),
    ];
    for outcome in DetectionOutcome::both(&l_room().with(solids)) {
        outcome.assert_objects(&objects(2), 0.9);
        assert!(
            (outcome.outline_m2() / L_AREA_M2 - 1.0).abs() < 0.08,
            "{}",
            outcome.outline_m2()
        );
    }
}

#[test]
fn a_box_on_the_floor_beside_the_table_is_none_of_its_objects() {
    for (x, y) in [(0.18, 0.16), (0.2, 0.18), (0.25, 0.25)] {
        let tall = PlacedShape::cuboid([0.15, 0.15, 0.38 + 0.15], [x, y, NEAR_FLOOR], OBJECT + 1);
        let solids = [on_table([0.08, 0.1, 0.12], [-0.2, 0.2], 0), tall];
        for outcome in DetectionOutcome::both(&l_room().with(solids)) {
            outcome.assert_objects(&objects(1), 0.9);
        }
    }
}

#[test]
fn a_convex_table_is_outlined_by_its_polygon() {
    for outcome in
        DetectionOutcome::both(&room().with([on_table([0.1, 0.08, 0.12], [0.1, 0.0], 0)]))
    {
        let table = outcome.table();
        assert_eq!(table.outline.corners, table.polygon.corners());
        assert!(
            (outcome.outline_m2() / 0.48 - 1.0).abs() < 0.03,
            "{}",
            outcome.outline_m2()
        );
        let rim_m = table.rim_distance_m(&outcome.on_table([0.3, 0.0, HIGH]));
        assert!((rim_m - 0.1).abs() < 0.01, "{rim_m}");
    }
}

#[test]
fn image_cut_sides_are_not_rim() {
    // Cut on the left and below: two sides of the outline are the end of the view.
    let corners = [[-1.5, -0.8], [0.3, -0.8], [0.3, 0.25], [-1.5, 0.25]];
    let scene = view().with([
        PlacedShape::polygon(&corners, HIGH, TABLE),
        PlacedShape::floor(),
    ]);
    for outcome in DetectionOutcome::both(&scene) {
        let outline = &outcome.table().outline;
        let n = outline.corners.len();
        for i in 0..n {
            let (a, b) = (outline.corners[i], outline.corners[(i + 1) % n]);
            let middle = Point2::from(0.5 * (a.coords + b.coords));
            let [right, far] = [[0.3, 0.0], [0.0, 0.25]].map(|[x, y]| {
                let axis = usize::from(x == 0.0);
                let world = outcome.scene.camera_from_world.inverse()
                    * outcome.table().table_from_camera.inverse()
                    * nalgebra::Point3::new(middle.x, middle.y, 0.0);
                (world[axis] - [x, y][axis]).abs() < 0.02
            });
            if (b - a).norm() > 0.05 {
                assert_eq!(outline.is_rim[i], right || far, "{a} {b} of {n}");
            }
        }
        let rim_m = |place: [f64; 3]| outcome.table().rim_distance_m(&outcome.on_table(place));
        assert!((rim_m([0.0, 0.0, HIGH]) - 0.25).abs() < 0.02);
        assert!((rim_m([0.35, 0.0, HIGH]) + 0.05).abs() < 0.02);
        assert!(
            rim_m([-0.6, 0.0, HIGH]) > 0.2,
            "beyond the left border of the view"
        );
    }
}

#[test]
fn table_goes_on_behind_what_hides_it() {
    // The tall box hides all of the table behind it; the other one looks over its top.
    let solids = [
        on_table([0.3, 0.05, 0.45], [0.3, -0.25], 0),
        on_table([0.1, 0.1, 0.45], [0.3, 0.15], 1),
    ];
    for outcome in DetectionOutcome::both(&room().with(solids)) {
        outcome.assert_objects(&objects(2), 0.9);
        let table = outcome.table();
        let hidden = outcome.on_table([0.38, 0.2, HIGH]);
        assert!(table.outline.contains(&hidden) && !table.polygon.contains(&hidden));
    }
}
