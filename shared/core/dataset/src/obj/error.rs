//! What can be wrong with an OBJ file.

use super::{MAX_TRIANGLES, MAX_VERTICES};
use crate::FileError;
use std::fmt;
use std::path::PathBuf;

/// Why an OBJ file or its materials could not be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    File(FileError),
    /// No line is a vertex.
    NoVertices,
    /// A line is wrong.
    Line {
        /// Its number, from 1; of a line that is continued, its first.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// There are more vertices or triangles than are ever read.
    TooLarge,
    /// There are more materials or libraries of them than are ever read.
    TooManyMaterials,
    /// A file of materials is wrong.
    Library {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<Error>,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NoVertices => f.write_str(
                "this is not an OBJ file with a mesh: no line \"v x y z\"; name another file",
            ),
            Self::Line { line, problem } => {
                write!(f, "line {line} of the OBJ file is wrong: {problem}")
            }
            Self::TooLarge => write!(
                f,
                "the OBJ file has more than {MAX_VERTICES} vertices or {MAX_TRIANGLES} triangles; \
                 make the mesh coarser"
            ),
            Self::TooManyMaterials => f.write_str(
                "the OBJ file has more than 65536 materials or 64 libraries of them; split it",
            ),
            Self::Library { path, source } => write!(
                f,
                "the materials {} can not be used: {source}",
                path.display()
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            Self::Library { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}
