//! PLY, the polygon file format of Stanford University, version 1.0.
//!
//! Read: ascii and binary of both byte orders; vertices with `x y z` as float
//! or double and `red green blue` as uchar; faces as lists `vertex_indices` or
//! `vertex_index`, each polygon cut into a fan of triangles. Other properties
//! and elements are skipped. A file without faces is a set of points, one
//! without colours is grey. Every index is checked, every coordinate is finite,
//! and nothing may follow the last element.
//!
//! Written: `x y z red green blue` and, if there are triangles, faces.

mod error;
mod header;
mod reader;
mod values;
mod writer;

pub use error::Error;
pub use reader::read;
pub use writer::{MeshView, write};

use crate::bounded_file::read_file;
use point_cloud::Point;
use std::path::Path;

/// Most vertices read from one file.
pub const MAX_VERTICES: usize = 1 << 24;

/// Most triangles read from one file.
pub const MAX_TRIANGLES: usize = 1 << 25;

/// Most bytes of one file.
pub const MAX_BYTES: u64 = 1 << 29;

/// How the numbers follow the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// A line of text for each vertex and face.
    Ascii,
    /// Bytes, the lowest of each number first.
    BinaryLittleEndian,
    /// Bytes, the highest of each number first.
    BinaryBigEndian,
}

/// The content of a PLY file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The vertices with their colours, in the units and frame of the file.
    pub vertices: Vec<Point>,
    /// Three indices of vertices for each triangle, in the order of the file.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Borrows the content for writing.
    pub fn view(&self) -> MeshView<'_> {
        MeshView {
            vertices: &self.vertices,
            triangles: &self.triangles,
        }
    }
}

/// Reads a whole PLY file.
///
/// # Errors
/// When the file can not be read, or as [`read`].
pub fn open(path: &Path) -> Result<Mesh, Error> {
    let mut bytes = Vec::new();
    read_file(path, MAX_BYTES, &mut bytes)?;
    read(&bytes)
}

#[cfg(test)]
mod tests;
