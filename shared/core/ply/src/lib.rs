//! PLY, the polygon file format of Stanford University, version 1.0, read and written as a
//! [`Mesh`].
//!
//! Read: ascii and binary of both byte orders; vertices with `x y z` as float
//! or double and `red green blue` as uchar; faces as lists `vertex_indices` or
//! `vertex_index`, each polygon cut into a fan of triangles. Other properties
//! and elements are skipped. A file without faces is a set of points, one
//! without colours is grey. Every index is checked, every coordinate is finite,
//! and nothing may follow the last element.
//!
//! Written: `x y z red green blue` and, if there are triangles, faces.
//!
//! This crate never panics on any input, and never reserves memory that the input does not
//! account for.

mod error;
mod header;
pub mod mesh;
mod reader;
mod value_reader;
mod writer;

pub use error::Error;
pub use mesh::{MAX_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh, MeshView};
pub use reader::read;
pub use writer::write;

use file_access::read_file;
use std::path::Path;

/// Colour of points from files without colours.
pub const NEUTRAL_GREY: point_cloud::Rgba = point_cloud::Rgba::opaque(128, 128, 128);

/// Encoding of the data after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Text, one line for each vertex and face.
    Ascii,
    /// Binary encoding, little-endian.
    BinaryLittleEndian,
    /// Binary encoding, big-endian.
    BinaryBigEndian,
}

/// Reads a PLY file.
///
/// # Errors
/// When the file cannot be read, or as [`read`].
pub fn open(path: &Path) -> Result<Mesh, Error> {
    let mut bytes = Vec::new();
    read_file(path, MAX_BYTES, &mut bytes)?;
    read(&bytes)
}

#[cfg(test)]
mod tests;
