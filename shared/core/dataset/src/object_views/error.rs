//! Errors of reading datasets of object views.

use crate::{FileError, pcd, washington};
use std::path::PathBuf;

/// Error of reading a dataset of object views, one of its folders or one of its views.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Invalid dataset or view in the Washington layout.
    #[error("{0}")]
    Washington(#[from] washington::Error),
    /// Folder without object views in either layout.
    #[error(
        "the folder {} holds no views of objects; it needs a folder of PCD files for each \
         category, or the layout of the Washington RGB-D Object Dataset",
        .0.display()
    )]
    NoViews(PathBuf),
    /// Dataset with more views than the limit.
    #[error("the folder {} holds more than a million views; split it", .0.display())]
    TooLarge(PathBuf),
    /// View index out of range.
    #[error("the data set has no view {index}; its {n_views} views count from 0")]
    NoSuchView {
        /// Requested view index, from 0.
        index: usize,
        /// Number of views in the dataset.
        n_views: usize,
    },
    /// Invalid PCD file.
    #[error("the view {} cannot be used: {source}", .path.display())]
    Pcd {
        /// Path of the PCD file.
        path: PathBuf,
        /// Error in the content of the PCD file.
        source: pcd::Error,
    },
    /// Object view without a single point with depth.
    #[error("the view {} has no point with depth; leave it out", .0.display())]
    NoPoints(PathBuf),
}
