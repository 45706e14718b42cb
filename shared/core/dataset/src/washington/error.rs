//! Errors of reading and writing datasets in the Washington layout.

use crate::{FileError, ImageError, pcd};
use std::path::PathBuf;

/// Error of reading or writing a dataset in the Washington layout.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Folder tree without views.
    #[error(
        "the folder {} holds no views of objects; they are called apple_1_1_1_crop.png \
         and so on",
        .0.display()
    )]
    NoViews(PathBuf),
    /// More views or folders than the limits.
    #[error(
        "the folder {} holds more than a million views or 65536 folders; split it",
        .0.display()
    )]
    TooLarge(PathBuf),
    /// File of a view that is present in two folders.
    #[error("the file {} is in another folder, too; remove one of them", .path.display())]
    Duplicate {
        /// Path of one of the two ambiguous files.
        path: PathBuf,
    },
    /// View index out of range.
    #[error("the data set has no view {index}; its {n_views} views count from 0")]
    NoSuchView {
        /// Requested view index, from 0.
        index: usize,
        /// Number of views in the dataset.
        n_views: usize,
    },
    /// View without the requested images or points.
    #[error("the view {name} of the data set has no {what}; request the part that it has")]
    MissingPart {
        /// Name of the Washington view.
        name: String,
        /// Missing part of the dataset: `images` or `points`.
        what: &'static str,
    },
    /// View to be written that already exists.
    #[error(
        "the view {} is already there; give the new one another number",
        .0.display()
    )]
    AlreadyExists(PathBuf),
    /// Vector of a view whose length does not match the crop size.
    #[error("a view with {found} {what} cannot be used; its size needs {needed}")]
    ViewLength {
        /// Name of the view's array, such as `depth`.
        what: &'static str,
        /// Length of the array.
        found: usize,
        /// Array length required by the crop size.
        needed: usize,
    },
    /// Crop rectangle that lies outside the largest image.
    #[error(
        "a view of {}x{} pixels at column {} and row {} cannot be used; an image has 1 \
         to 8192 pixels a side",
        .size.0, .size.1, .top_left.0, .top_left.1
    )]
    CropBounds {
        /// Width and height of the crop, pixels.
        size: (u32, u32),
        /// Column and row of the first pixel in the whole image.
        top_left: (u32, u32),
    },
    /// Invalid content of a file of the dataset.
    #[error("the file {} cannot be used: {source}", .path.display())]
    Content {
        /// Path of the invalid file.
        path: PathBuf,
        /// Error in the content of the file.
        source: ContentError,
    },
}

/// Invalid content of one file of a view.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContentError {
    /// Text that is not the column and row of a crop.
    #[error("it must hold a column and a row from 1 to 8192, such as 272,183")]
    Location,
    /// Damaged image, or image of another size or pixel format.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Invalid PCD file.
    #[error("{0}")]
    Cloud(#[from] pcd::Error),
}
