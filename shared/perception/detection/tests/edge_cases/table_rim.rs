//! Objects at the rim of the table and growth to the support plane.

use crate::detection_outcome::{DetectionOutcome, NO_CANDIDATE};
use crate::synthetic_scene::{OBJECT, PlacedShape, TABLE};
use crate::{HIGH, objects, on_table, room};
use nalgebra::{Isometry3, Point3};

#[test]
fn overhanging_points_belong_to_their_object() {
    for (at, sides) in [
        ([0.4, 0.0], [0.16, 0.1, 0.1]),
        ([-0.1, -0.3], [0.1, 0.16, 0.1]),
        ([0.0, 0.3], [0.1, 0.16, 0.1]),
    ] {
        for outcome in DetectionOutcome::both(&room().with([on_table(sides, at, 0)])) {
            outcome.assert_objects(&objects(1), 0.9);
            let number = outcome.best(OBJECT).0;
            let (points, _) = outcome.scene.render();
            let world_from_camera: Isometry3<f64> = outcome.scene.camera_from_world.inverse();
            // On the top and sides, above the table's height.
            let beyond = (0..points.len()).filter(|&i| {
                let at: Point3<f64> = world_from_camera * points[i].position();
                outcome.truth[i] == OBJECT
                    && at.z > HIGH + 0.012
                    && (at.x.abs() > 0.4 || at.y.abs() > 0.3)
            });
            let (mut n, mut n_held) = (0_u32, 0_u32);
            for pixel in beyond {
                n += 1;
                n_held += u32::from(outcome.candidate_of[pixel] == number);
            }
            assert!(
                n > 500 && f64::from(n_held) > 0.98 * f64::from(n),
                "{n_held} of {n} at {at:?}"
            );
        }
    }
}

#[test]
fn support_plane_growth_adds_the_base_and_no_table() {
    for is_stepped in [false, true] {
        let solids = [
            on_table([0.1, 0.08, 0.12], [-0.2, 0.0], 0).turned(20.0),
            on_table([0.12, 0.1, 0.06], [0.15, 0.1], 1).turned(30.0),
            on_table([0.06, 0.06, 0.2], [0.05, -0.15], 2).turned(40.0),
        ];
        let mut scene = room().with(solids);
        scene.is_stepped = is_stepped;
        for outcome in DetectionOutcome::both(&scene) {
            outcome.assert_objects(&objects(3), 0.95);
            for object in objects(3) {
                let share = outcome.labelled_share(object);
                // Regression bound: the steepest face is seen nearly edge-on and loses a
                // few pixels.
                assert!(share > 0.965, "{share} of {object}, stepped: {is_stepped}");
            }
            let width = outcome.scene.camera.width as usize;
            let far_from_objects = |pixel: usize| {
                let near = |at: usize| at.saturating_sub(10)..at + 11;
                near(pixel / width).all(|row| {
                    near(pixel % width).all(|column| {
                        outcome
                            .truth
                            .get(row * width + column)
                            .is_none_or(|&what| what < OBJECT)
                    })
                })
            };
            let wrong = (0..outcome.truth.len()).filter(|&pixel| {
                outcome.truth[pixel] == TABLE
                    && outcome.candidate_of[pixel] != NO_CANDIDATE
                    && far_from_objects(pixel)
            });
            assert_eq!(wrong.count(), 0);
        }
    }
}

#[test]
fn support_plane_growth_stops_before_objects_behind() {
    let solids = [
        PlacedShape::cylinder(0.04, 0.15, [0.05, -0.12, HIGH], OBJECT),
        on_table([0.12, 0.1, 0.06], [0.15, 0.1], 1).turned(30.0),
    ];
    let outcome = DetectionOutcome::of(&room().with(solids));
    let (number, _) = outcome.best(OBJECT);
    let sides_m = outcome.detection.candidates[number].oriented_box.sides_m();
    assert!((sides_m.x - 0.08).abs() < 0.01, "{sides_m}");
}

#[test]
fn furniture_behind_the_rim_is_no_object() {
    // Backs of chairs: a board from the floor, and a slat above the height of the table.
    let board = PlacedShape::cuboid([0.4, 0.03, HIGH + 0.12], [0.0, 0.37, 0.0], OBJECT + 1);
    let slat = PlacedShape::cuboid([0.4, 0.03, 0.1], [0.0, 0.37, HIGH + 0.02], OBJECT + 1);
    for furniture in [board, slat] {
        let solids = [on_table([0.1, 0.08, 0.12], [0.1, 0.0], 0), furniture];
        for outcome in DetectionOutcome::both(&room().with(solids)) {
            outcome.assert_objects(&objects(1), 0.9);
        }
    }
}
