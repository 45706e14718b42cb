//! Image geometry: empty margins, odd sizes and other resolutions.

use crate::detection_outcome::{DetectionOutcome, detected};
use crate::synthetic_scene::{NOTHING, OBJECT, PlacedShape, SyntheticScene};
use crate::{HIGH, objects, on_table, room};
use nalgebra::Vector3;
use point_cloud::{Point, Rgba};

fn three_objects() -> SyntheticScene {
    room().with([
        on_table([0.1, 0.08, 0.12], [-0.2, 0.0], 0).turned(20.0),
        on_table([0.12, 0.1, 0.06], [0.2, 0.1], 1).turned(30.0),
        PlacedShape::cylinder(0.04, 0.15, [0.0, -0.12, HIGH], OBJECT + 2),
    ])
}

#[test]
fn empty_margins_do_not_change_the_result() {
    const MARGIN: usize = 30;
    let scene = three_objects();
    let (mut points, mut truth) = scene.render();
    let before = DetectionOutcome::of_points(&scene, &points, truth.clone(), None);
    let (width, height) = (640, 480);
    for i in 0..width * height {
        let within = |at: usize, n: usize| (MARGIN..n - MARGIN).contains(&at);
        if !within(i % width, width) || !within(i / width, height) {
            points[i] = Point::without_depth(Rgba::default());
            truth[i] = NOTHING;
        }
    }
    let after = DetectionOutcome::of_points(&scene, &points, truth, None);
    before.assert_objects(&objects(3), 0.9);
    after.assert_objects(&objects(3), 0.9);
    for (a, b) in before
        .detection
        .candidates
        .iter()
        .zip(&after.detection.candidates)
    {
        assert!((a.centroid - b.centroid).norm() < 0.002);
        assert!((a.oriented_box.sides_m() - b.oriented_box.sides_m()).amax() < 0.005);
        assert!(!a.touches_image_border && !b.touches_image_border);
    }
}

#[test]
fn image_border_flag_uses_the_border_of_depth() {
    const MARGIN: usize = 30;
    let scene = three_objects();
    let (mut points, truth) = scene.render();
    // The margin on the left ends inside the leftmost object.
    let first = truth
        .iter()
        .enumerate()
        .filter(|(_, what)| **what == OBJECT)
        .map(|(i, _)| i % 640);
    let first = first.min().unwrap() + MARGIN;
    for (i, point) in points.iter_mut().enumerate() {
        if i % 640 < first || i / 640 < MARGIN {
            *point = Point::without_depth(Rgba::default());
        }
    }
    let outcome = DetectionOutcome::of_points(&scene, &points, truth, None);
    assert_eq!(outcome.n_candidates(), 3);
    for (number, candidate) in outcome.detection.candidates.iter().enumerate() {
        assert_eq!(
            candidate.touches_image_border,
            number == outcome.best(OBJECT).0
        );
    }
}

/// Border marks of a box on the left and of a book in the middle, where points chosen by
/// their pixel, place and label have no depth.
fn border_marks(is_lost: impl Fn(usize, &Point, u16) -> bool) -> Vec<bool> {
    let scene = room().with([
        on_table([0.1, 0.08, 0.12], [-0.25, 0.1], 0).turned(20.0),
        on_table([0.2, 0.2, 0.03], [0.05, -0.1], 1),
    ]);
    let (mut points, truth) = scene.render();
    for (i, point) in points.iter_mut().enumerate() {
        if is_lost(i, point, truth[i]) {
            *point = Point::without_depth(Rgba::default());
        }
    }
    let outcome = DetectionOutcome::of_points(&scene, &points, truth, None);
    let candidates = &outcome.detection.candidates;
    let mark = |object| candidates[outcome.best(object).0].touches_image_border;
    objects(2).into_iter().map(mark).collect()
}

#[test]
fn near_limit_of_the_depth_range_cuts_an_object() {
    let nearest = |_: usize, point: &Point, _: u16| point.z < 0.95;
    assert_eq!(border_marks(nearest), [false, true]);
}

#[test]
fn missing_depth_beside_a_farther_object_is_no_near_limit() {
    // From the middle of the left object down to the image border.
    let dark = |pixel: usize, point: &Point, label: u16| {
        let below = pixel / 640 > 240 && pixel % 640 < 260;
        label != OBJECT && below && point.is_finite()
    };
    assert_eq!(border_marks(dark), [false; 2]);
    assert_eq!(border_marks(|_, _, _| false), [false; 2]);
}

#[test]
fn the_smallest_images_have_no_table() {
    let there = Point {
        x: 0.0,
        y: 0.0,
        z: 1.0,
        color: Rgba::default(),
    };
    let absent = Point::without_depth(Rgba::default());
    let n = 300;
    for size in [
        (1, 1),
        (1, n),
        (n, 1),
        (2, 2),
        (2, n),
        (n, 2),
        (3, 3),
        (17, 5),
    ] {
        for point in [there, absent] {
            for up in [None, Some(-Vector3::y_axis())] {
                let found = detected(&vec![point; size.0 * size.1], size, up);
                assert!(
                    found.surfaces.is_empty() && found.candidates.is_empty(),
                    "{size:?}"
                );
            }
        }
    }
}

#[test]
fn image_width_may_be_arbitrary() {
    for n_columns in [1, 3, 7, 9, 15, 100] {
        DetectionOutcome::of(&three_objects().narrowed(n_columns)).assert_objects(&objects(3), 0.9);
    }
}

/// Assert that a scene shows the same objects at another resolution.
fn assert_same_at(factor: f64) {
    let full = DetectionOutcome::of(&three_objects());
    full.assert_objects(&objects(3), 0.9);
    let other = DetectionOutcome::of(&three_objects().scaled(factor));
    other.assert_objects(&objects(3), 0.85);
    for object in objects(3) {
        let [a, b] = [&full, &other].map(|outcome| {
            outcome.detection.candidates[outcome.best(object).0]
                .oriented_box
                .centre()
        });
        assert!((a - b).norm() < 0.012, "{object} at {factor}: {a} and {b}");
    }
}

#[test]
fn other_resolutions_show_the_same_objects() {
    assert_same_at(0.5);
    assert_same_at(2.0);
}
