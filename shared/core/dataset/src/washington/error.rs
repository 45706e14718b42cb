//! What can be wrong with a data set of objects.

use crate::png_image::PngError;
use crate::{FileError, pcd};
use std::fmt;
use std::path::PathBuf;

/// Why a data set of objects could not be read or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder could not be read or written.
    File(FileError),
    /// The folder and those in it hold no views.
    NoViews(PathBuf),
    /// There are more views or folders than are ever listed.
    TooLarge(PathBuf),
    /// A view's file is in two folders.
    Twice {
        /// One of the two files.
        path: PathBuf,
    },
    /// There are not as many views.
    NoSuchView {
        /// The view that was asked for, from 0.
        index: usize,
        /// How many there are.
        n_views: usize,
    },
    /// A view lacks what was asked for.
    Missing {
        /// The view.
        name: String,
        /// Its images or its points.
        what: &'static str,
    },
    /// The folder for a new view already holds it.
    AlreadyThere(PathBuf),
    /// A vector of a view does not fill the cut-out.
    ViewLength {
        /// Which vector.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        needed: usize,
    },
    /// A cut-out can not be a part of an image.
    Place {
        /// Its columns and rows.
        size: (u32, u32),
        /// Column and row of its first pixel.
        top_left: (u32, u32),
    },
    /// The content of a file is wrong.
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ContentError,
    },
}

/// What is wrong inside one file of a view.
#[derive(Debug)]
#[non_exhaustive]
pub enum ContentError {
    /// A place of a cut-out is none.
    Location,
    /// An image can not be decoded.
    Png(png::DecodingError),
    /// An image can not be encoded.
    Encoding(png::EncodingError),
    /// An image is of another kind than a view has.
    ImageKind(&'static str),
    /// An image does not have the size of the colour image.
    ImageSize {
        /// Its columns and rows.
        found: (u32, u32),
        /// The columns and rows of the colour image.
        needed: (u32, u32),
    },
    /// The points can not be read.
    Cloud(pcd::Error),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NoViews(folder) => write!(
                f,
                "the folder {} holds no views of objects; they are called apple_1_1_1_crop.png \
                 and so on",
                folder.display()
            ),
            Self::TooLarge(folder) => write!(
                f,
                "the folder {} holds more than a million views or 65536 folders; split it",
                folder.display()
            ),
            Self::Twice { path } => write!(
                f,
                "the file {} is in another folder, too; remove one of them",
                path.display()
            ),
            Self::NoSuchView { index, n_views } => write!(
                f,
                "the data set has no view {index}; its {n_views} views count from 0"
            ),
            Self::Missing { name, what } => write!(
                f,
                "the view {name} of the data set has no {what}; ask for what it has"
            ),
            Self::AlreadyThere(path) => write!(
                f,
                "the view {} is already there; give the new one another number",
                path.display()
            ),
            Self::ViewLength {
                what,
                found,
                needed,
            } => write!(
                f,
                "a view with {found} {what} can not be used; its size needs {needed}"
            ),
            Self::Place { size, top_left } => write!(
                f,
                "a view of {}x{} pixels at column {} and row {} can not be used; an image has 1 \
                 to 8192 pixels a side",
                size.0, size.1, top_left.0, top_left.1
            ),
            Self::Content { path, source } => {
                write!(f, "the file {} can not be used: {source}", path.display())
            }
        }
    }
}

impl fmt::Display for ContentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Location => {
                f.write_str("it must hold a column and a row from 1 to 8192, such as 272,183")
            }
            Self::Png(error) => write!(f, "the PNG image is damaged: {error}"),
            Self::Encoding(error) => write!(f, "the PNG image can not be made: {error}"),
            Self::ImageKind(problem) => f.write_str(problem),
            Self::ImageSize { found, needed } => write!(
                f,
                "the image has {}x{} pixels, and the colour image of the view {}x{}",
                found.0, found.1, needed.0, needed.1
            ),
            Self::Cloud(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            Self::Content { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl std::error::Error for ContentError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Png(error) => Some(error),
            Self::Encoding(error) => Some(error),
            Self::Cloud(error) => Some(error),
            _ => None,
        }
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

impl From<PngError> for ContentError {
    fn from(error: PngError) -> Self {
        match error {
            PngError::Decoding(error) => Self::Png(error),
            PngError::Kind(rule) => Self::ImageKind(rule),
        }
    }
}

impl From<pcd::Error> for ContentError {
    fn from(error: pcd::Error) -> Self {
        Self::Cloud(error)
    }
}
