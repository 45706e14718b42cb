//! Mesh instance: a mesh with a pose, an id and a texture.

use crate::{PreparedMesh, Texture};
use geometry::RigidTransform;

/// Mesh instance in the world.
#[derive(Debug, Clone, Copy)]
pub struct Instance<'a> {
    /// Geometry and colours of the instance.
    pub mesh: &'a PreparedMesh,
    /// Pose in the world. An instance whose transform is not finite is not drawn.
    pub world_from_mesh: RigidTransform,
    /// Instance id, written to the pixels that show it; 0 stands for empty pixels.
    pub id: u16,
    /// Procedural texture that multiplies the mesh's colours.
    pub texture: Texture,
}

impl<'a> Instance<'a> {
    /// Mesh instance without texture.
    pub fn new(mesh: &'a PreparedMesh, world_from_mesh: RigidTransform, id: u16) -> Self {
        Self {
            mesh,
            world_from_mesh,
            id,
            texture: Texture::None,
        }
    }
}
