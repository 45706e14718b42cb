//! Support of objects that hide the place on which they stand.

use crate::detection_outcome::DetectionOutcome;
use crate::synthetic_scene::{OBJECT, PlacedShape, Shape, SyntheticScene};
use crate::{HIGH, room, table};
use detection::Support;

fn from_above() -> SyntheticScene {
    SyntheticScene::seen_from([0.0, -0.35, HIGH + 0.85], [0.0, 0.0, HIGH])
        .with([table(), PlacedShape::floor()])
}

/// Support of the only candidate of a scene.
fn support(outcome: &DetectionOutcome) -> Option<Support> {
    assert_eq!(outcome.n_candidates(), 1);
    outcome.detection.candidates[0].support
}

#[test]
fn a_ball_stands_on_the_table_below_it() {
    for scene in [room(), from_above()] {
        for radius in [0.05, 0.08, 0.11] {
            let ball = PlacedShape::new(Shape::Ball(radius), [0.1, 0.05, HIGH], OBJECT);
            for outcome in DetectionOutcome::both(&scene.clone().with([ball])) {
                assert!(support(&outcome).is_some(), "radius {radius} m");
            }
        }
    }
}

#[test]
fn what_hovers_over_a_visible_table_has_no_support() {
    for scene in [room(), from_above()] {
        for height_m in [0.12, 0.2] {
            let ball = PlacedShape::new(Shape::Ball(0.05), [0.0, 0.0, HIGH + height_m], OBJECT);
            for outcome in DetectionOutcome::both(&scene.clone().with([ball])) {
                assert_eq!(support(&outcome), None, "{height_m} m over the table");
            }
        }
    }
}
