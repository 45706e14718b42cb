//! Object model of a file: mesh, unit, upward axis, notes.

use crate::mesh::Mesh;

/// Object model of a file, with what the file says about its frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FileModel {
    /// Coloured mesh in the units and frame of the file.
    pub mesh: Mesh,
    /// Length of the unit, metres, if the file tells it: positive and finite.
    pub unit_m: Option<f32>,
    /// Upward axis, if the file tells it.
    pub up: Option<UpAxis>,
    /// Parts of the model that could not be used, one clause each.
    pub notes: Vec<String>,
}

/// Coordinate axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpAxis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

impl From<Mesh> for FileModel {
    /// Model of a file that has a mesh and no more.
    fn from(mesh: Mesh) -> Self {
        Self {
            mesh,
            ..Self::default()
        }
    }
}
