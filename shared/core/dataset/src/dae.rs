//! DAE, the XML format COLLADA 1.4 of the Khronos Group, read as a [`FileModel`].
//!
//! Read: geometries of `triangles`, `polylist` and `polygons`, each polygon cut
//! into a fan; the nodes of the visual scene with `matrix`, `translate`,
//! `rotate` and `scale`; the diffuse colour or texture of effects, and colours
//! of vertices; the unit, and the upward axis, which is y in a file that does
//! not tell it. Textures are treated as those of OBJ files. Strips, fans,
//! moving parts, cameras and lights are skipped; skipped surfaces are told in
//! a note.
//!
//! A document type is refused, and with it every entity.

mod appearance;
mod document;
mod geometry;
mod scene;

use crate::textured_mesh::TexturedMesh;
use crate::{FileModel, ModelError, UpAxis, texture_folder};
use appearance::Appearances;
use document::{Document, child};
use file_access::read_file;
use std::path::Path;

/// Maximum size of a DAE file, bytes.
pub const MAX_BYTES: u64 = 1 << 27;

/// Maximum number of triangles, and of vertices, of one model: a geometry can be placed many times.
pub const MAX_TRIANGLES: usize = 1 << 22;

/// Maximum number of XML nodes of a file.
const MAX_NODES: u32 = 1 << 22;

/// Reads a DAE file with its textures, all from the file's folder.
///
/// # Errors
/// When the file cannot be read, or as [`read`]. An image that cannot be used is a note.
pub fn open(path: &Path) -> Result<FileModel, ModelError> {
    let mut bytes = Vec::new();
    read_file(path, MAX_BYTES, &mut bytes)?;
    let (mut model, textured, appearances) = read_textured(&bytes)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let textures = texture_folder::load(folder, appearances.texture_names(), &mut model.notes);
    model.mesh = textured.baked(&textures);
    Ok(model)
}

/// Decodes a DAE file from its bytes, without textures.
///
/// *Allocation*: the XML tree, at most some 4 million nodes; the vertices and triangles.
///
/// # Errors
/// When the bytes are not a DAE file with triangles, or an element is wrong; says which and why.
pub fn read(bytes: &[u8]) -> Result<FileModel, ModelError> {
    let (model, textured, _) = read_textured(bytes)?;
    Ok(FileModel {
        mesh: textured.mesh,
        ..model
    })
}

fn read_textured(bytes: &[u8]) -> Result<(FileModel, TexturedMesh, Appearances), ModelError> {
    let text = std::str::from_utf8(bytes).map_err(|_| ModelError::NotText)?;
    // Without a document type there are no entities that could expand.
    let options = roxmltree::ParsingOptions {
        allow_dtd: false,
        nodes_limit: MAX_NODES,
        ..roxmltree::ParsingOptions::default()
    };
    let tree = roxmltree::Document::parse_with_options(text, options)?;
    let root = tree.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(ModelError::NotCollada);
    }
    let document = Document::new(root);
    let mut appearances = Appearances::default();
    let mut notes = Vec::new();
    let mesh = scene::read(&document, &mut appearances, &mut notes)?;
    let asset = child(root, "asset");
    let unit = asset.and_then(|asset| child(asset, "unit"));
    let unit_m = unit.and_then(|unit| unit.attribute("meter")?.trim().parse().ok());
    let up = asset.and_then(|asset| child(asset, "up_axis"));
    let model = FileModel {
        unit_m: unit_m.filter(|unit_m: &f32| (1e-9..1e9).contains(unit_m)),
        up: Some(match up.and_then(|up| up.text()).map(str::trim) {
            Some("X_UP") => UpAxis::X,
            Some("Z_UP") => UpAxis::Z,
            _ => UpAxis::Y,
        }),
        notes,
        ..FileModel::default()
    };
    Ok((model, mesh, appearances))
}

#[cfg(test)]
mod tests;
