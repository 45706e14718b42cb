//! What can be wrong with a PLY file.

use super::{MAX_TRIANGLES, MAX_VERTICES};
use crate::FileError;
use std::fmt;

/// Why a PLY file could not be read or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read.
    File(FileError),
    /// The text at the start has no end.
    NoHeader,
    /// A line of the header is wrong.
    HeaderLine {
        /// Its number, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The elements do not make a mesh.
    Elements(&'static str),
    /// There are more vertices or triangles than are ever read.
    TooLarge,
    /// An element is longer than the rest of the file.
    Truncated {
        /// Its name.
        element: String,
    },
    /// A row of an element is wrong.
    Row {
        /// The name of the element.
        element: String,
        /// Which row, from 0.
        row: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Something follows the last element.
    TrailingData,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NoHeader => f.write_str(
                "this is not a PLY file: no lines from \"ply\" to \"end_header\" within the first \
                 64 KiB; name another file",
            ),
            Self::HeaderLine { line, problem } => {
                write!(f, "line {line} of the PLY header is wrong: {problem}")
            }
            Self::Elements(problem) => {
                write!(f, "the PLY file does not describe a mesh: {problem}")
            }
            Self::TooLarge => write!(
                f,
                "the PLY file has more than {MAX_VERTICES} vertices or {MAX_TRIANGLES} triangles; \
                 make the mesh coarser"
            ),
            Self::Truncated { element } => write!(
                f,
                "the PLY file ends before its element \"{element}\" is complete; copy it again"
            ),
            Self::Row {
                element,
                row,
                problem,
            } => {
                write!(
                    f,
                    "row {row} of element \"{element}\" in the PLY file is wrong: {problem}"
                )
            }
            Self::TrailingData => f.write_str(
                "the PLY file goes on behind its last element; its header announces too little",
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            _ => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}
