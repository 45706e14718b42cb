//! Room geometry: fixed boxes for table, floor, wall and bin.

use crate::furniture::{Bin, TableDimensions, TableFinish};
use crate::physics::Physics;
use crate::scene::Scene;
use geometry::RigidTransform;
use nalgebra::Vector3;

/// Thickness of the table top, metres.
const TOP_THICKNESS_M: f64 = 0.03;
/// Side of a table leg, metres.
const LEG_SIDE_M: f64 = 0.06;
/// Half side of the floor, metres.
const FLOOR_REACH_M: f64 = 4.0;
/// World y coordinate of the back wall, metres.
const WALL_Y_M: f64 = 1.9;
/// Height of the back wall, metres.
const WALL_HEIGHT_M: f64 = 2.6;
/// Thickness of the bin's walls, metres.
const BIN_WALL_M: f64 = 0.008;

/// Material of a box of the room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Material {
    /// Tiles of the floor.
    Tiles,
    /// Plaster of the back wall, sRGB.
    Plaster([u8; 3]),
    /// Finish of the table top and legs.
    Table(TableFinish),
    /// Cardboard of the bin.
    Cardboard,
}

/// Axis-aligned box of the room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RoomBox {
    pub(crate) centre_m: Vector3<f64>,
    pub(crate) half_sides_m: Vector3<f64>,
    pub(crate) material: Material,
}

impl RoomBox {
    /// Room box between two corners.
    fn between(low: [f64; 3], high: [f64; 3], material: Material) -> Self {
        let (low, high) = (Vector3::from(low), Vector3::from(high));
        Self {
            centre_m: (low + high) / 2.0,
            half_sides_m: (high - low) / 2.0,
            material,
        }
    }

    pub(crate) fn world_from_box(&self) -> RigidTransform {
        RigidTransform::from_parts(self.centre_m.into(), nalgebra::UnitQuaternion::identity())
    }
}

/// All boxes of a scene's room.
pub(crate) fn room_boxes(scene: &Scene) -> Vec<RoomBox> {
    let r = FLOOR_REACH_M;
    let mut boxes = vec![
        RoomBox::between([-r, -r, -0.1], [r, r, 0.0], Material::Tiles),
        RoomBox::between(
            [-r, WALL_Y_M, 0.0],
            [r, WALL_Y_M + 0.1, WALL_HEIGHT_M],
            Material::Plaster(scene.lighting.wall_color()),
        ),
    ];
    boxes.extend(table(&scene.table, scene.table_finish));
    if let Some(bin) = &scene.bin {
        boxes.extend(bin_walls(bin, scene.table.height_m));
    }
    boxes
}

fn table(table: &TableDimensions, finish: TableFinish) -> Vec<RoomBox> {
    let [x, y] = table.size_m.map(|side| side / 2.0);
    let (top, under) = (table.height_m, table.height_m - TOP_THICKNESS_M);
    let mut boxes = vec![RoomBox::between(
        [-x, -y, under],
        [x, y, top],
        Material::Table(finish),
    )];
    for (sx, sy) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let foot = [sx * (x - LEG_SIDE_M), sy * (y - LEG_SIDE_M)];
        let half = LEG_SIDE_M / 2.0;
        boxes.push(RoomBox::between(
            [foot[0] - half, foot[1] - half, 0.0],
            [foot[0] + half, foot[1] + half, under],
            Material::Table(finish),
        ));
    }
    boxes
}

fn bin_walls(bin: &Bin, table_m: f64) -> [RoomBox; 4] {
    let [x, y] = [bin.inner_size_m[0] / 2.0, bin.inner_size_m[1] / 2.0];
    let (w, low, high) = (BIN_WALL_M, table_m, table_m + bin.inner_size_m[2]);
    let wall = |from: [f64; 2], to: [f64; 2]| {
        RoomBox::between(
            [from[0], from[1], low],
            [to[0], to[1], high],
            Material::Cardboard,
        )
    };
    [
        wall([-x - w, -y - w], [-x, y + w]),
        wall([x, -y - w], [x + w, y + w]),
        wall([-x, -y - w], [x, -y]),
        wall([-x, y], [x, y + w]),
    ]
}

/// Adds the room to the physics.
pub(crate) fn build(boxes: &[RoomBox], physics: &mut Physics) {
    for room_box in boxes {
        physics.add_fixture(&room_box.world_from_box(), &room_box.half_sides_m);
    }
}
