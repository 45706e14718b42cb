//! Hollow objects: pots, rings, mugs.

use crate::detection_outcome::{DetectionOutcome, NO_CANDIDATE};
use crate::synthetic_scene::{OBJECT, PlacedShape, Shape, SyntheticScene, TABLE};
use crate::{HIGH, objects, room, table};

fn hollow(radius: f64, height: f64, floor: f64) -> PlacedShape {
    let shape = Shape::Cylinder {
        radius,
        height,
        bore: radius - 0.004,
        floor,
    };
    PlacedShape::new(shape, [0.0, 0.0, HIGH], OBJECT)
}

/// Number of counted pixels inside the bore, and of those in a candidate.
fn seen_within(
    outcome: &DetectionOutcome,
    bore: f64,
    is_counted: impl Fn(u16, f64) -> bool,
) -> (usize, usize) {
    let (points, _) = outcome.scene.render();
    let world_from_camera = outcome.scene.camera_from_world.inverse();
    let (mut n, mut n_labelled) = (0, 0);
    for (i, point) in points.iter().enumerate() {
        let at = world_from_camera * point.position();
        if at.x.hypot(at.y) < bore - 0.006 && is_counted(outcome.truth[i], at.z - HIGH) {
            n += 1;
            n_labelled += usize::from(outcome.candidate_of[i] != NO_CANDIDATE);
        }
    }
    (n, n_labelled)
}

fn from_above() -> SyntheticScene {
    SyntheticScene::seen_from([0.0, -0.45, HIGH + 0.85], [0.0, 0.0, HIGH])
        .with([table(), PlacedShape::floor()])
}

#[test]
fn the_floor_of_a_pot_belongs_to_it() {
    for (radius, height) in [(0.11, 0.08), (0.09, 0.10), (0.06, 0.05)] {
        for outcome in DetectionOutcome::both(&from_above().with([hollow(radius, height, 0.005)])) {
            let (n, n_labelled) = seen_within(&outcome, radius, |_, above_m| above_m < 0.015);
            assert!(
                n > 100 && n_labelled as f64 > 0.9 * n as f64,
                "{n_labelled} of {n}"
            );
        }
    }
}

#[test]
fn the_table_within_a_ring_belongs_to_nothing() {
    for (radius, height) in [(0.11, 0.08), (0.09, 0.03), (0.06, 0.05)] {
        for outcome in DetectionOutcome::both(&from_above().with([hollow(radius, height, 0.0)])) {
            let (n, n_labelled) = seen_within(&outcome, radius, |what, _| what == TABLE);
            assert!(
                n > 100 && (n_labelled as f64) < 0.1 * n as f64,
                "{n_labelled} of {n}"
            );
            outcome.assert_objects(&objects(1), 0.85);
        }
    }
}

#[test]
fn a_mug_with_a_handle_stays_whole() {
    let bar =
        |sides: [f64; 3], x: f64, z: f64| PlacedShape::cuboid(sides, [x, 0.0, HIGH + z], OBJECT);
    let mug = || {
        [
            hollow(0.04, 0.10, 0.005),
            bar([0.035, 0.012, 0.012], 0.055, 0.02),
            bar([0.035, 0.012, 0.012], 0.055, 0.068),
            bar([0.012, 0.012, 0.06], 0.067, 0.02),
        ]
    };
    for scene in [room(), from_above()] {
        for outcome in DetectionOutcome::both(&scene.with(mug())) {
            outcome.assert_objects(&objects(1), 0.88);
        }
    }
}
