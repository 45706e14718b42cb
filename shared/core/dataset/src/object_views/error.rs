//! What can be wrong with a data set of views.

use crate::{FileError, pcd, washington};
use std::fmt;
use std::path::PathBuf;

/// Why a data set, a part of it, or a view could not be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder could not be read.
    File(FileError),
    /// A data set in the layout of Washington, or a view of it, can not be used.
    Washington(washington::Error),
    /// The folder holds no views of either layout.
    NoViews(PathBuf),
    /// There are more views than are ever listed.
    TooLarge(PathBuf),
    /// There are not as many views.
    NoSuchView {
        /// The view that was asked for, from 0.
        index: usize,
        /// How many there are.
        n_views: usize,
    },
    /// A PCD file can not be used.
    Pcd {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: pcd::Error,
    },
    /// A view has no point with depth.
    NoPoints(PathBuf),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::Washington(error) => error.fmt(f),
            Self::NoViews(folder) => write!(
                f,
                "the folder {} holds no views of objects; it needs a folder of PCD files for each \
                 category, or the layout of the Washington RGB-D Object Dataset",
                folder.display()
            ),
            Self::TooLarge(folder) => write!(
                f,
                "the folder {} holds more than a million views; split it",
                folder.display()
            ),
            Self::NoSuchView { index, n_views } => write!(
                f,
                "the data set has no view {index}; its {n_views} views count from 0"
            ),
            Self::Pcd { path, source } => {
                write!(f, "the view {} can not be used: {source}", path.display())
            }
            Self::NoPoints(path) => write!(
                f,
                "the view {} has no point with depth; leave it out",
                path.display()
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            Self::Washington(error) => Some(error),
            Self::Pcd { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

impl From<washington::Error> for Error {
    fn from(error: washington::Error) -> Self {
        Self::Washington(error)
    }
}
