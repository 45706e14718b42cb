//! Setting of a kind of scene: table, finish of the table and camera, unless they are given.

use super::clutter::{clutter_camera, clutter_table, clutter_table_finish};
use crate::camera_mount::CameraMount;
use crate::furniture::{Shelf, TableDimensions, TableFinish};
use crate::scene::SceneKind;

/// Lowest board of a shelf.
const SHELF_TABLE: TableDimensions = TableDimensions {
    size_m: [1.0, 0.42],
    height_m: 0.45,
};
/// Camera before a shelf: distance in metres, elevation in degrees.
const SHELF_CAMERA: (f64, f64) = (1.3, 20.0);

/// Setting of a scene: drawn from the seed for a crowded table, fixed for all others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SceneSetting {
    kind: Option<SceneKind>,
    seed: u64,
}

impl SceneSetting {
    /// Setting of a kind of scene with a seed; `None` for a scene without a generator.
    pub(crate) fn of(kind: Option<SceneKind>, seed: u64) -> Self {
        Self { kind, seed }
    }

    /// Table dimensions of the setting.
    pub(crate) fn table(self) -> TableDimensions {
        match self.kind {
            Some(SceneKind::Clutter) => clutter_table(self.seed),
            Some(SceneKind::Shelf) => SHELF_TABLE,
            _ => TableDimensions::default(),
        }
    }

    /// Table finish of the setting.
    pub(crate) fn table_finish(self) -> TableFinish {
        match self.kind {
            Some(SceneKind::Clutter) => clutter_table_finish(self.seed),
            _ => TableFinish::default(),
        }
    }

    /// Camera mount of the setting before a table with `n_objects` objects.
    pub(crate) fn camera(self, table: &TableDimensions, n_objects: usize) -> CameraMount {
        match self.kind {
            Some(SceneKind::Clutter) => clutter_camera(self.seed, table, n_objects),
            Some(SceneKind::Shelf) => shelf_camera(table),
            _ => CameraMount::default(),
        }
    }
}

/// Camera that looks at the middle of the default shelf.
fn shelf_camera(table: &TableDimensions) -> CameraMount {
    let shelf = Shelf::default();
    let middle_m = shelf.spacing_m * shelf.n_boards as f64 / 2.0;
    let (distance_m, elevation_deg) = SHELF_CAMERA;
    CameraMount {
        look_at_m: [0.0, 0.0, table.height_m + middle_m],
        distance_m,
        elevation_deg,
        ..CameraMount::default()
    }
}
