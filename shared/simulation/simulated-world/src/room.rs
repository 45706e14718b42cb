//! Table, floor, wall and bin: boxes that never move.

use crate::physics::Physics;
use crate::scene::{Bin, Scene, Table};
use geometry::RigidTransform;
use nalgebra::Vector3;

/// Thickness of the table's top, metres.
const TOP_THICKNESS_M: f64 = 0.03;
/// Side of a table's leg, metres.
const LEG_SIDE_M: f64 = 0.06;
/// How far the floor reaches from the middle, metres.
const FLOOR_REACH_M: f64 = 4.0;
/// Where the back wall stands, world y, metres.
const WALL_Y_M: f64 = 1.9;
/// Height of the back wall, metres.
const WALL_HEIGHT_M: f64 = 2.6;
/// Thickness of the bin's walls, metres.
const BIN_WALL_M: f64 = 0.008;

/// What a box of the room is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Material {
    /// The floor.
    Tiles,
    /// The back wall.
    Plaster,
    /// Table top and legs.
    Wood,
    /// The bin.
    Cardboard,
}

/// One box of the room, parallel to the world's axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    pub(crate) centre_m: Vector3<f64>,
    pub(crate) half_sides_m: Vector3<f64>,
    pub(crate) material: Material,
}

impl Block {
    /// Between two corners.
    fn between(low: [f64; 3], high: [f64; 3], material: Material) -> Self {
        let (low, high) = (Vector3::from(low), Vector3::from(high));
        Self {
            centre_m: (low + high) / 2.0,
            half_sides_m: (high - low) / 2.0,
            material,
        }
    }

    pub(crate) fn world_from_block(&self) -> RigidTransform {
        RigidTransform::from_parts(self.centre_m.into(), nalgebra::UnitQuaternion::identity())
    }
}

/// All boxes of a scene's room.
pub(crate) fn blocks(scene: &Scene) -> Vec<Block> {
    let r = FLOOR_REACH_M;
    let mut blocks = vec![
        Block::between([-r, -r, -0.1], [r, r, 0.0], Material::Tiles),
        Block::between(
            [-r, WALL_Y_M, 0.0],
            [r, WALL_Y_M + 0.1, WALL_HEIGHT_M],
            Material::Plaster,
        ),
    ];
    blocks.extend(table(&scene.table));
    if let Some(bin) = &scene.bin {
        blocks.extend(bin_walls(bin, scene.table.height_m));
    }
    blocks
}

fn table(table: &Table) -> Vec<Block> {
    let [x, y] = table.size_m.map(|side| side / 2.0);
    let (top, under) = (table.height_m, table.height_m - TOP_THICKNESS_M);
    let mut blocks = vec![Block::between([-x, -y, under], [x, y, top], Material::Wood)];
    for (sx, sy) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let foot = [sx * (x - LEG_SIDE_M), sy * (y - LEG_SIDE_M)];
        let half = LEG_SIDE_M / 2.0;
        blocks.push(Block::between(
            [foot[0] - half, foot[1] - half, 0.0],
            [foot[0] + half, foot[1] + half, under],
            Material::Wood,
        ));
    }
    blocks
}

fn bin_walls(bin: &Bin, table_m: f64) -> [Block; 4] {
    let [x, y] = [bin.inner_size_m[0] / 2.0, bin.inner_size_m[1] / 2.0];
    let (w, low, high) = (BIN_WALL_M, table_m, table_m + bin.inner_size_m[2]);
    let wall = |from: [f64; 2], to: [f64; 2]| {
        Block::between(
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

/// Puts the room into the physics.
pub(crate) fn build(blocks: &[Block], physics: &mut Physics) {
    for block in blocks {
        physics.add_fixture(&block.world_from_block(), &block.half_sides_m);
    }
}
