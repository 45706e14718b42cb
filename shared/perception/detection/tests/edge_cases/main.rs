//! Rare tables, views and images: no table, several, cut, concave, covered, unusual
//! viewpoints and image sizes.

mod detection_outcome;
mod hidden_bases;
mod hollow_objects;
mod image_geometry;
mod levels_and_walls;
mod segmentation;
mod several_tables;
#[path = "../synthetic/synthetic_scene.rs"]
mod synthetic_scene;
mod table_outline;
mod table_rim;
mod table_selection;

use synthetic_scene::{OBJECT, PlacedShape, SyntheticScene, TABLE};

/// Height of the table over the floor, metres.
const HIGH: f64 = 0.72;

/// View from 0.6 m over the table, 0.85 m in front of its centre.
fn view() -> SyntheticScene {
    SyntheticScene::seen_from([0.0, -0.85, HIGH + 0.6], [0.0, 0.0, HIGH])
}

/// Table that is entirely in view.
fn table() -> PlacedShape {
    PlacedShape::rectangle([0.8, 0.6], HIGH, TABLE)
}

/// View of that table over the floor.
fn room() -> SyntheticScene {
    view().with([table(), PlacedShape::floor()])
}

/// Box that stands on the table.
fn on_table(sides: [f64; 3], at: [f64; 2], n: u16) -> PlacedShape {
    PlacedShape::cuboid(sides, [at[0], at[1], HIGH], OBJECT + n)
}

/// Labels of the first `n` objects in the scene.
fn objects(n: u16) -> Vec<u16> {
    (OBJECT..OBJECT + n).collect()
}
