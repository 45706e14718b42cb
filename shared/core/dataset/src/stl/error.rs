//! Errors of reading STL files.

use super::{MAX_TRIANGLES, MAX_VERTICES};
use file_access::FileError;

/// Error of reading an STL file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to the STL file.
    #[error("{0}")]
    File(#[from] FileError),
    /// Content that is neither binary nor text STL.
    #[error(
        "this is not an STL file: it neither begins with \"solid\" nor has the header of a binary \
         file; name another file"
    )]
    NotStl,
    /// Binary file shorter than its triangles.
    #[error("the STL file announces {announced} triangles and ends after {present}; copy it again")]
    Truncated {
        /// Number of triangles in the header.
        announced: u32,
        /// Number of complete triangles in the file.
        present: usize,
    },
    /// Text file that ends within a solid.
    #[error("the STL file ends before the line \"endsolid\"; copy it again")]
    EndOfText,
    /// Unexpected data after the last triangle.
    #[error("the STL file goes on behind its last triangle; its header announces too little")]
    TrailingData,
    /// Invalid line of a text file.
    #[error("line {line} of the STL file is wrong: {problem}")]
    Line {
        /// Line number, from 1.
        line: usize,
        /// Reason why the content is invalid, as a clause.
        problem: String,
    },
    /// Coordinate of a binary file that is not finite.
    #[error("triangle {triangle} of the STL file has a coordinate that is not finite; repair it")]
    NotFinite {
        /// Number of the triangle, from 0.
        triangle: usize,
    },
    /// More vertices or triangles than the limits.
    #[error(
        "the STL file has more than {max_vertices} vertices or {max_triangles} triangles; \
         make the mesh coarser",
        max_vertices = MAX_VERTICES,
        max_triangles = MAX_TRIANGLES
    )]
    TooLarge,
}
