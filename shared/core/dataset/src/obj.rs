//! OBJ, the text format of Wavefront Technologies for meshes, read as a [`Mesh`] or,
//! with its textures, as a [`FileModel`].
//!
//! Read: vertices `v x y z`, also with a weight, which is ignored, or with
//! `r g b` from 0 to 1; faces `f`, each polygon cut into a fan of triangles,
//! whose corners count from 1, or backwards from the last vertex with negative
//! numbers; texture coordinates `vt`; `mtllib` and `usemtl`. Normals, groups
//! and all other lines are skipped. A file without faces is a set of points.
//!
//! A vertex has the colour of the texture `map_Kd` of the material of its
//! faces, or its own colour, or the diffuse colour `Kd` of the material, or is
//! grey. A texture is not multiplied with `Kd`, which many programs write
//! without meaning it. Large triangles are divided, so that their vertices
//! show the texture. A vertex between faces of several colours becomes
//! several vertices, appended to those of the file.
//!
//! Libraries and textures are read from the file's own folder and its
//! subfolders only. One that is missing or cannot be used is told in a note.
//!
//! A text truncated at the end of a line cannot be distinguished from a complete one.

mod lines;
mod materials;
mod reader;
mod vertex_colors;

pub use crate::mesh::{MAX_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh};
pub use materials::{Materials, material_libraries};
pub use reader::read;

use crate::folder_path::{parent, path_below};
use crate::{FileModel, ModelError, texture_folder};
use file_access::excerpt;
use file_access::read_file;
use std::path::Path;

/// Maximum size of a material library, bytes.
const MAX_LIBRARY_BYTES: u64 = 1 << 24;

/// Reads an OBJ file with its material libraries and textures, all from the file's folder.
/// Materials of a missing library have no colour.
///
/// # Errors
/// When a file cannot be read, or as [`read`] and [`Materials::read`]. An image that cannot be
/// used is a note.
pub fn open(path: &Path) -> Result<FileModel, ModelError> {
    let mut bytes = Vec::new();
    read_file(path, MAX_BYTES, &mut bytes)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut notes = Vec::new();
    let mut materials = Materials::default();
    for name in material_libraries(&bytes)? {
        if let Err(problem) = add_library(folder, name, &mut materials)? {
            let name = excerpt(name);
            notes.push(format!("its materials \"{name}\" are left out: {problem}"));
        }
    }
    let textured = reader::read_textured(&bytes, &materials)?;
    let textures = texture_folder::load(folder, materials.texture_names(), &mut notes);
    Ok(FileModel {
        mesh: textured.baked(&textures),
        notes,
        ..FileModel::default()
    })
}

/// Adds a material library; the inner error is a clause about one that is left out.
fn add_library(
    folder: &Path,
    name: &str,
    materials: &mut Materials,
) -> Result<Result<(), &'static str>, ModelError> {
    let Some(below) = path_below("", name) else {
        return Ok(Err(
            "their path leads out of the model's folder; put them there",
        ));
    };
    let path = folder.join(&below);
    if !path.exists() {
        return Ok(Err("the file is missing; put it into the model's folder"));
    }
    let mut library = Vec::new();
    read_file(&path, MAX_LIBRARY_BYTES, &mut library)?;
    let read = materials.read_in(parent(&below), &library);
    read.map(Ok).map_err(|source| ModelError::Library {
        path,
        source: Box::new(source),
    })
}

#[cfg(test)]
mod tests;
