//! STL, the stereolithography format of 3D Systems, read as a [`Mesh`].
//!
//! Read: binary files, whose size must be that of their triangles, and text
//! files with one or several solids. The corners of the triangles are welded:
//! equal positions are one vertex, so that neighbours share their corners.
//! Normals are skipped, because the order of the corners has the same meaning,
//! and so are the attribute bytes. The format has neither colours nor a unit:
//! the mesh is grey.

mod reader;

pub use crate::mesh::{MAX_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh};
pub use reader::read;

use crate::ModelError;
use file_access::read_file;
use std::path::Path;

/// Reads an STL file.
///
/// # Errors
/// When the file cannot be read, or as [`read`].
pub fn open(path: &Path) -> Result<Mesh, ModelError> {
    let mut bytes = Vec::new();
    read_file(path, MAX_BYTES, &mut bytes)?;
    read(&bytes)
}

#[cfg(test)]
mod tests;
