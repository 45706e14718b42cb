//! OBJ, the text format of Wavefront Technologies for meshes, read as a [`Mesh`].
//!
//! Read: vertices `v x y z`, also with a weight, which is ignored, or with
//! `r g b` from 0 to 1; faces `f`, each polygon cut into a fan of triangles,
//! whose corners count from 1, or backwards from the last vertex with negative
//! numbers; `mtllib` and `usemtl`. Texture coordinates, normals, groups and all
//! other lines are skipped. A file without faces is a set of points.
//!
//! A vertex has its own colour, or the diffuse colour `Kd` of the material of
//! its faces, or is grey. A vertex between faces of several materials becomes
//! several vertices, appended to those of the file. Textures are not read.
//!
//! A text truncated at the end of a line cannot be distinguished from a complete one.

mod error;
mod lines;
mod materials;
mod reader;
mod vertex_colors;

pub use crate::mesh::{MAX_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh};
pub use error::Error;
pub use materials::{Materials, material_libraries};
pub use reader::read;

use crate::bounded_file::read_file;
use std::path::Path;

/// Maximum size of a material library, bytes.
const MAX_LIBRARY_BYTES: u64 = 1 << 24;

/// Reads an OBJ file with its material libraries. Libraries are read from the file's own folder
/// only; materials of a missing library have no colour.
///
/// # Errors
/// When a file cannot be read, or as [`read`] and [`Materials::read`].
pub fn open(path: &Path) -> Result<Mesh, Error> {
    let (mut bytes, mut library) = (Vec::new(), Vec::new());
    read_file(path, MAX_BYTES, &mut bytes)?;
    let mut materials = Materials::default();
    for name in material_libraries(&bytes)? {
        let path = path.with_file_name(name);
        if path.exists() {
            read_file(&path, MAX_LIBRARY_BYTES, &mut library)?;
            materials.read(&library).map_err(|source| Error::Library {
                path,
                source: Box::new(source),
            })?;
        }
    }
    read(&bytes, &materials)
}

#[cfg(test)]
mod tests;
