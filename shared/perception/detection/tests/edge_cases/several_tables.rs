//! Table selection among several tables in one view.

use crate::detection_outcome::DetectionOutcome;
use crate::synthetic_scene::{OBJECT, PlacedShape, SyntheticScene, TABLE};
use crate::{HIGH, objects};
use detection::{ScenePriors, TableChoice};

/// Rectangular test table with its centre at a point.
fn table_at(sides: [f64; 2], [x, y]: [f64; 2], z: f64) -> PlacedShape {
    let [a, b] = sides.map(|side| 0.5 * side);
    PlacedShape::polygon(
        &[
            [x - a, y - b],
            [x + a, y - b],
            [x + a, y + b],
            [x - a, y + b],
        ],
        z,
        TABLE,
    )
}

fn view() -> SyntheticScene {
    SyntheticScene::seen_from([0.0, -1.0, HIGH + 0.7], [0.0, 0.0, HIGH])
}

#[test]
fn of_two_tables_side_by_side_the_larger_is_chosen() {
    let lower = table_at([0.6, 0.5], [-0.35, 0.0], HIGH - 0.2);
    let upper = table_at([0.4, 0.4], [0.35, 0.0], HIGH);
    let on_lower = PlacedShape::cuboid([0.1, 0.1, 0.12], [-0.3, 0.0, HIGH - 0.2], OBJECT);
    let on_upper = PlacedShape::cuboid([0.1, 0.1, 0.12], [0.3, 0.0, HIGH], OBJECT + 1);
    let scene = view().with([lower, upper, on_lower, on_upper]);
    for outcome in DetectionOutcome::both(&scene) {
        assert!((outcome.table_height_m([0.0, 0.0]) - (HIGH - 0.2)).abs() < 0.003);
        assert_eq!(outcome.table().choice, TableChoice::Most);
        outcome.assert_objects(&[OBJECT], 0.9);
    }
}

#[test]
fn a_table_over_a_lower_one_is_chosen() {
    let lower = table_at([0.8, 0.6], [0.0, -0.15], HIGH - 0.4);
    let upper = table_at([0.8, 0.3], [0.0, 0.3], HIGH);
    let on_upper = PlacedShape::cuboid([0.1, 0.1, 0.12], [0.3, 0.3, HIGH], OBJECT);
    let scene = view().with([lower, upper, on_upper]);
    for outcome in DetectionOutcome::both(&scene) {
        assert!((outcome.table_height_m([0.0, 0.3]) - HIGH).abs() < 0.003);
        let choice = outcome.table().choice;
        let truth = [
            TableChoice::OverLarger { n_others: 1 },
            TableChoice::Largest { n_others: 1 },
        ];
        assert!(truth.contains(&choice), "{choice:?}");
        outcome.assert_objects(&objects(1), 0.9);
    }
}

#[test]
fn table_choice_names_a_floor_under_the_table() {
    let scene = view().with([table_at([0.5, 0.4], [0.0, 0.0], HIGH), PlacedShape::floor()]);
    for outcome in DetectionOutcome::both(&scene) {
        let choice = outcome.table().choice;
        assert_eq!(choice, TableChoice::OverLarger { n_others: 1 }, "{choice}");
    }
}

#[test]
fn of_two_tables_of_one_height_the_larger_is_chosen_and_the_other_counted() {
    let tables = [
        table_at([0.35, 0.5], [-0.35, 0.0], HIGH),
        table_at([0.30, 0.5], [0.3, 0.0], HIGH),
    ];
    let on_both = [-0.35, 0.3].map(|x| [x, 0.0, HIGH]);
    let scene = view().with(tables).with([
        PlacedShape::cuboid([0.1, 0.1, 0.12], on_both[0], OBJECT),
        PlacedShape::cuboid([0.1, 0.1, 0.12], on_both[1], OBJECT + 1),
    ]);
    for floor in [None, Some(PlacedShape::floor())] {
        for outcome in DetectionOutcome::both(&scene.clone().with(floor.clone())) {
            outcome.assert_objects(&[OBJECT], 0.9);
            assert!(
                (outcome.outline_m2() - 0.175).abs() < 0.02,
                "{}",
                outcome.outline_m2()
            );
            let choice = outcome.table().choice;
            let n_others = 1 + usize::from(floor.is_some());
            let truth = [
                TableChoice::Largest { n_others },
                TableChoice::OverLarger { n_others },
            ];
            assert!(truth.contains(&choice), "{choice:?}");
        }
    }
}

#[test]
fn table_of_earlier_frames_stays_the_table_while_it_is_seen() {
    let lower = table_at([0.6, 0.5], [-0.35, 0.0], HIGH - 0.2);
    let upper = table_at([0.4, 0.4], [0.35, 0.0], HIGH);
    let on_lower = PlacedShape::cuboid([0.1, 0.1, 0.12], [-0.3, 0.0, HIGH - 0.2], OBJECT);
    let on_upper = PlacedShape::cuboid([0.1, 0.1, 0.12], [0.3, 0.0, HIGH], OBJECT + 1);
    let both = view().with([
        lower.clone(),
        upper.clone(),
        on_lower.clone(),
        on_upper.clone(),
    ]);
    let upper_alone = DetectionOutcome::of(&view().with([upper, on_upper]));
    let expected = ScenePriors {
        surfaces: &[upper_alone.table().plane],
        ..ScenePriors::default()
    };
    let outcome = DetectionOutcome::with_priors(&both, expected);
    assert_eq!(outcome.table().choice, TableChoice::Kept);
    assert!((outcome.table_height_m([0.35, 0.0]) - HIGH).abs() < 0.003);
    outcome.assert_objects(&[OBJECT + 1], 0.9);
    // What the image alone would give is told, so that most images can decide.
    let by_image = DetectionOutcome::of(&both).table().plane;
    assert!((outcome.table().plane_by_image.offset_m - by_image.offset_m).abs() < 0.002);
    // A table that is gone is not kept.
    let outcome = DetectionOutcome::with_priors(&view().with([lower, on_lower]), expected);
    assert_ne!(outcome.table().choice, TableChoice::Kept);
    outcome.assert_objects(&[OBJECT], 0.9);
}
