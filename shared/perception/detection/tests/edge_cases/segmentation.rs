//! Segmentation: touching objects are separated, single objects stay whole.

use crate::detection_outcome::DetectionOutcome;
use crate::synthetic_scene::{OBJECT, PlacedShape};
use crate::{HIGH, objects, on_table, room};

const GREY: [u8; 3] = [150, 150, 150];

#[test]
fn boxes_of_one_color_one_behind_the_other_come_apart() {
    let solids = [
        on_table([0.14, 0.10, 0.08], [0.0, -0.05], 0).painted(GREY),
        on_table([0.14, 0.10, 0.18], [0.0, 0.05], 1).painted(GREY),
    ];
    DetectionOutcome::of(&room().with(solids)).assert_objects(&objects(2), 0.85);
}

#[test]
fn boxes_of_one_color_one_on_the_other_come_apart() {
    let upper = PlacedShape::cuboid([0.10, 0.08, 0.10], [0.0, 0.02, HIGH + 0.08], OBJECT + 1);
    let solids =
        [on_table([0.20, 0.18, 0.08], [0.0, 0.0], 0), upper].map(|solid| solid.painted(GREY));
    DetectionOutcome::of(&room().with(solids)).assert_objects(&objects(2), 0.85);
}

#[test]
fn a_box_seen_at_its_corner_stays_whole() {
    for is_stepped in [false, true] {
        for yaw_deg in [20.0, 45.0, 70.0] {
            let mut scene =
                room().with([on_table([0.16, 0.16, 0.18], [0.0, 0.0], 0).turned(yaw_deg)]);
            scene.is_stepped = is_stepped;
            DetectionOutcome::of(&scene).assert_objects(&objects(1), 0.95);
        }
    }
}

#[test]
fn a_cylinder_stays_whole() {
    for (radius, height) in [(0.05, 0.20), (0.09, 0.12), (0.03, 0.10)] {
        let scene = room().with([PlacedShape::cylinder(
            radius,
            height,
            [0.0, 0.0, HIGH],
            OBJECT,
        )]);
        DetectionOutcome::of(&scene).assert_objects(&objects(1), 0.95);
    }
}

/// Ten touching objects: three on the table at the back with three on top, four in front.
fn pile() -> [PlacedShape; 10] {
    let at = |x: f64, y: f64, z: f64| [x, y, HIGH + z];
    [
        on_table([0.20, 0.14, 0.09], [-0.14, 0.08], 0),
        on_table([0.16, 0.14, 0.09], [0.05, 0.09], 1).turned(8.0),
        on_table([0.10, 0.12, 0.16], [0.20, 0.08], 2).turned(-10.0),
        PlacedShape::cylinder(0.045, 0.14, at(-0.12, -0.05, 0.0), OBJECT + 3),
        on_table([0.13, 0.09, 0.06], [0.0, -0.05], 4).turned(15.0),
        on_table([0.09, 0.09, 0.09], [0.13, -0.05], 5).turned(-20.0),
        PlacedShape::cylinder(0.04, 0.10, at(0.05, 0.10, 0.09), OBJECT + 6),
        PlacedShape::cuboid([0.12, 0.08, 0.07], at(-0.17, 0.08, 0.09), OBJECT + 7).turned(12.0),
        PlacedShape::cuboid([0.08, 0.06, 0.12], at(-0.06, 0.10, 0.09), OBJECT + 8).turned(-5.0),
        on_table([0.08, 0.06, 0.05], [-0.22, -0.06], 9).turned(35.0),
    ]
}

/// Intersection over union of each object of the pile, and the number of candidates.
fn pile_overlaps(is_stepped: bool) -> (Vec<f64>, usize) {
    let mut scene = room().with(pile());
    scene.is_stepped = is_stepped;
    let outcome = DetectionOutcome::of(&scene);
    let overlaps = objects(10)
        .iter()
        .map(|&object| outcome.best(object).1)
        .collect();
    (overlaps, outcome.n_candidates())
}

#[test]
fn most_objects_in_a_pile_of_ten_come_out() {
    for is_stepped in [false, true] {
        let (overlaps, n_candidates) = pile_overlaps(is_stepped);
        let n_clear = overlaps.iter().filter(|&&overlap| overlap > 0.5).count();
        assert!(
            n_clear >= 8 && (8..=12).contains(&n_candidates),
            "{n_candidates} {overlaps:?}"
        );
    }
}
