//! Rendered boxes of the room: meshes, materials and textures.

use crate::furniture::{TableFinish, TablePattern};
use crate::room::{Material, RoomBox};
use geometry::RigidTransform;
use mesh::{Surface, rounded_box};
use rendering::{Instance, PreparedMesh, Texture};

/// Rounding radius of furniture edges, metres.
const EDGE_M: f32 = 0.003;
/// Mesh resolution of large faces, since light is computed per corner, metres.
const CELL_M: f32 = 0.5;

/// Box of the room, ready for rendering.
#[derive(Debug)]
pub(super) struct RoomPiece {
    mesh: PreparedMesh,
    world_from_mesh: RigidTransform,
    texture: Texture,
}

impl RoomPiece {
    pub(super) fn instance(&self) -> Instance<'_> {
        Instance {
            texture: self.texture,
            ..Instance::new(&self.mesh, self.world_from_mesh, 0)
        }
    }
}

pub(super) fn room_pieces(boxes: &[RoomBox]) -> Vec<RoomPiece> {
    boxes.iter().map(piece).collect()
}

fn piece(room_box: &RoomBox) -> RoomPiece {
    let (color, specular, texture) = look(room_box.material);
    let sides = (room_box.half_sides_m * 2.0).cast::<f32>();
    let solid = rounded_box(sides.into(), EDGE_M, CELL_M)
        .colored(color)
        .with_surface(Surface {
            specular,
            infrared: 1.0,
        });
    RoomPiece {
        mesh: PreparedMesh::new(&solid.mesh),
        world_from_mesh: room_box.world_from_box(),
        texture,
    }
}

fn table_texture(finish: TableFinish) -> Texture {
    let contrast = f32::from(finish.contrast_percent) / 100.0;
    match finish.pattern {
        TablePattern::WoodGrain => Texture::WoodGrain {
            board_m: 0.13,
            contrast,
        },
        TablePattern::Mottle => Texture::Mottle {
            scale_m: 0.04,
            contrast,
        },
        TablePattern::Plain => Texture::None,
    }
}

fn look(material: Material) -> ([u8; 3], f32, Texture) {
    match material {
        Material::Tiles => (
            [150, 146, 138],
            0.08,
            Texture::Tiles {
                side_m: 0.4,
                joint_m: 0.006,
            },
        ),
        Material::Plaster(color) => (
            color,
            0.0,
            Texture::Mottle {
                scale_m: 0.35,
                contrast: 0.08,
            },
        ),
        Material::Table(finish) => (finish.color, 0.06, table_texture(finish)),
        Material::Plastic => ([74, 96, 112], 0.1, Texture::None),
        Material::Cardboard => (
            [176, 140, 98],
            0.0,
            Texture::Mottle {
                scale_m: 0.05,
                contrast: 0.08,
            },
        ),
    }
}
