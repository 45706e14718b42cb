//! Setting of a kind of scene: table, finish of the table and camera, unless they are given.

use super::clutter::{clutter_camera, clutter_table, clutter_table_finish};
use crate::camera_mount::CameraMount;
use crate::furniture::{TableDimensions, TableFinish};
use crate::scene::SceneKind;

/// Setting of a scene: drawn from the seed for a crowded table, the default for all others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SceneSetting {
    clutter_seed: Option<u64>,
}

impl SceneSetting {
    /// Setting of a kind of scene with a seed; `None` for a scene without a generator.
    pub(crate) fn of(kind: Option<SceneKind>, seed: u64) -> Self {
        Self {
            clutter_seed: (kind == Some(SceneKind::Clutter)).then_some(seed),
        }
    }

    /// Table dimensions of the setting.
    pub(crate) fn table(self) -> TableDimensions {
        self.clutter_seed
            .map_or_else(Default::default, clutter_table)
    }

    /// Table finish of the setting.
    pub(crate) fn table_finish(self) -> TableFinish {
        self.clutter_seed
            .map_or_else(Default::default, clutter_table_finish)
    }

    /// Camera mount of the setting before a table with `n_objects` objects.
    pub(crate) fn camera(self, table: &TableDimensions, n_objects: usize) -> CameraMount {
        self.clutter_seed.map_or_else(Default::default, |seed| {
            clutter_camera(seed, table, n_objects)
        })
    }
}
