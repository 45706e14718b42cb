//! Table of a scene.

use geometry::Plane;
use message::SceneSummary;
use nalgebra::{Unit, Vector3};

/// Plane of the table in the world, which is the camera's frame while its pose is not known; `None`
/// without a table.
pub fn table_in_world(scene: &SceneSummary) -> Option<Plane> {
    let [x, y, z, offset_m] = scene.table()?.plane;
    let normal = Unit::try_new(Vector3::new(x, y, z), 1e-6)?;
    Some(Plane { normal, offset_m })
}
