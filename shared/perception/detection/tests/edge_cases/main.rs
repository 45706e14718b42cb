//! Tables and objects as they are rarely: no table, several, cut, concave,
//! covered, seen from odd places and in odd images.

mod concavity_split;
mod detection_outcome;
mod hollow_objects;
mod image_geometry;
mod several_tables;
#[path = "../synthetic/synthetic_scene.rs"]
mod synthetic_scene;
mod table_outline;
mod table_rim;
mod table_selection;

use synthetic_scene::{OBJECT, Scene, Solid, TABLE};

/// Height of the table over the floor, metres.
const HIGH: f64 = 0.72;

/// A camera 0.6 m over the table, 0.85 m before its middle.
fn view() -> Scene {
    Scene::seen_from([0.0, -0.85, HIGH + 0.6], [0.0, 0.0, HIGH])
}

/// A table that is wholly in view.
fn table() -> Solid {
    Solid::rectangle([0.8, 0.6], HIGH, TABLE)
}

/// The view of that table over the floor.
fn room() -> Scene {
    view().with([table(), Solid::floor()])
}

/// A box on the table.
fn on_table(sides: [f64; 3], at: [f64; 2], n: u16) -> Solid {
    Solid::cuboid(sides, [at[0], at[1], HIGH], OBJECT + n)
}

/// PointLabels of the first objects.
fn objects(n: u16) -> Vec<u16> {
    (OBJECT..OBJECT + n).collect()
}
