//! A mesh in its place.

use crate::{PreparedMesh, Texture};
use geometry::RigidTransform;

/// A mesh that stands somewhere in the world.
#[derive(Debug, Clone, Copy)]
pub struct Instance<'a> {
    /// What it looks like.
    pub mesh: &'a PreparedMesh,
    /// Where it is. An instance whose transform is not finite is not drawn.
    pub world_from_mesh: RigidTransform,
    /// Written to the pixels where it is seen; 0 means nothing.
    pub id: u16,
    /// Detail on top of the mesh's colours.
    pub texture: Texture,
}

impl<'a> Instance<'a> {
    /// A mesh without texture.
    pub fn new(mesh: &'a PreparedMesh, world_from_mesh: RigidTransform, id: u16) -> Self {
        Self {
            mesh,
            world_from_mesh,
            id,
            texture: Texture::None,
        }
    }
}
