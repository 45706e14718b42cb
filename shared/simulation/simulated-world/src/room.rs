//! Room geometry: fixed boxes for table, floor, wall, bin, shelf and tray.

use crate::furniture::{Bin, Shelf, TableDimensions, TableFinish, Tray};
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
    /// Plastic of the tray.
    Plastic,
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
    if let Some(shelf) = &scene.shelf {
        boxes.extend(shelf_boards(shelf, &scene.table, scene.table_finish));
    }
    if let Some(tray) = &scene.tray {
        boxes.extend(tray_boxes(tray, scene.table.height_m));
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
    let [x, y, z] = bin.inner_size_m;
    rim([x / 2.0, y / 2.0], BIN_WALL_M, [table_m, table_m + z])
        .map(|(low, high)| RoomBox::between(low, high, Material::Cardboard))
}

/// Four walls around a rectangle, given by its half sides; `z_m` are the bottom and the top of
/// the walls. Returns the two corners of each.
fn rim([x, y]: [f64; 2], width_m: f64, z_m: [f64; 2]) -> [([f64; 3], [f64; 3]); 4] {
    let w = width_m;
    [
        ([-x - w, -y - w], [-x, y + w]),
        ([x, -y - w], [x + w, y + w]),
        ([-x, -y - w], [x, -y]),
        ([-x, y], [x, y + w]),
    ]
    .map(|(low, high)| ([low[0], low[1], z_m[0]], [high[0], high[1], z_m[1]]))
}

/// Boards, sides and back of a shelf, which end at its highest board.
fn shelf_boards(shelf: &Shelf, table: &TableDimensions, finish: TableFinish) -> Vec<RoomBox> {
    let [x, y] = table.size_m.map(|side| side / 2.0);
    let thick = Shelf::BOARD_M;
    let top = table.height_m + shelf.height_m();
    let board = |low, high| RoomBox::between(low, high, Material::Table(finish));
    let mut boxes = vec![
        board([-x - thick, -y, 0.0], [-x, y, top]),
        board([x, -y, 0.0], [x + thick, y, top]),
        board([-x - thick, y, 0.0], [x + thick, y + thick, top]),
    ];
    boxes.extend(shelf.board_heights_m().map(|level| {
        let z = table.height_m + level;
        board([-x, -y, z - thick], [x, y, z])
    }));
    boxes
}

/// Floor and rim of a tray.
fn tray_boxes(tray: &Tray, table_m: f64) -> Vec<RoomBox> {
    let half = tray.inner_size_m.map(|side| side / 2.0);
    let floor = table_m + tray.floor_m;
    let plastic = |(low, high)| RoomBox::between(low, high, Material::Plastic);
    let mut boxes = vec![plastic((
        [-half[0], -half[1], table_m],
        [half[0], half[1], floor],
    ))];
    let walls = rim(half, Tray::RIM_WIDTH_M, [table_m, floor + tray.rim_m]);
    boxes.extend(walls.map(plastic));
    boxes
}

/// Adds the room to the physics.
pub(crate) fn build(boxes: &[RoomBox], physics: &mut Physics) {
    for room_box in boxes {
        physics.add_fixture(&room_box.world_from_box(), &room_box.half_sides_m);
    }
}
