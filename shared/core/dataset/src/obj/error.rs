//! Errors of reading OBJ files.

use super::{MAX_TRIANGLES, MAX_VERTICES};
use file_access::FileError;
use std::path::PathBuf;

/// Error of reading an OBJ file or its material libraries.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to an OBJ file or material library.
    #[error("{0}")]
    File(#[from] FileError),
    /// OBJ file without vertex lines.
    #[error("this is not an OBJ file with a mesh: no line \"v x y z\"; name another file")]
    NoVertices,
    /// Invalid line of an OBJ file or material library.
    #[error("line {line} of the OBJ file is wrong: {problem}")]
    Line {
        /// Line number, from 1; the first one of a continued line.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// More vertices or triangles than the limits.
    #[error(
        "the OBJ file has more than {max_vertices} vertices or {max_triangles} triangles; \
         make the mesh coarser",
        max_vertices = MAX_VERTICES,
        max_triangles = MAX_TRIANGLES
    )]
    TooLarge,
    /// More materials or material libraries than the limits.
    #[error("the OBJ file has more than 65536 materials or 64 libraries of them; split it")]
    TooManyMaterials,
    /// Invalid material library.
    #[error("the materials {} cannot be used: {source}", .path.display())]
    Library {
        /// Path of the material library.
        path: PathBuf,
        /// Error in the content of the material library.
        source: Box<Error>,
    },
}
