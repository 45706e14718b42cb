//! Errors of reading and writing PLY files.

use crate::{MAX_TRIANGLES, MAX_VERTICES};
use file_access::FileError;

/// Error of reading or writing a PLY file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to the PLY file.
    #[error("{0}")]
    File(#[from] FileError),
    /// File without a complete PLY header.
    #[error(
        "this is not a PLY file: no lines from \"ply\" to \"end_header\" within the first \
         64 KiB; name another file"
    )]
    NoHeader,
    /// Invalid line of the PLY header.
    #[error("line {line} of the PLY header is wrong: {problem}")]
    HeaderLine {
        /// Line number in the PLY header, from 1.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Elements that do not describe a mesh.
    #[error("the PLY file does not describe a mesh: {0}")]
    Elements(&'static str),
    /// More vertices or triangles than the limits.
    #[error(
        "the PLY file has more than {max_vertices} vertices or {max_triangles} triangles; \
         make the mesh coarser",
        max_vertices = MAX_VERTICES,
        max_triangles = MAX_TRIANGLES
    )]
    TooLarge,
    /// Element that needs more bytes than the rest of the file.
    #[error("the PLY file ends before its element \"{element}\" is complete; copy it again")]
    Truncated {
        /// Name of the truncated PLY element.
        element: String,
    },
    /// Invalid row of a PLY element.
    #[error("row {row} of element \"{element}\" in the PLY file is wrong: {problem}")]
    Row {
        /// Name of the PLY element with the invalid row.
        element: String,
        /// Row number within the PLY element, from 0.
        row: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Unexpected data after the last PLY element.
    #[error("the PLY file goes on behind its last element; its header announces too little")]
    TrailingData,
}
