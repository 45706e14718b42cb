//! Errors of reading and writing RGB-D sequences.

use crate::{FileError, ImageError};
use geometry::InvalidIntrinsics;
use std::path::PathBuf;

/// Error of reading or writing an RGB-D sequence.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Folder without depth images.
    #[error(
        "the folder {} holds no frames of an RGB-D sequence; they are called \
         frame-000000.depth.png and so on",
        .0.display()
    )]
    NoFrames(PathBuf),
    /// Depth image without colour image, or colour image without depth image.
    #[error(
        "the image {} has no companion that ends in {missing}; add or remove one",
        .path.display()
    )]
    Unpaired {
        /// Path of the image that has no companion.
        path: PathBuf,
        /// File name suffix of the missing companion.
        missing: &'static str,
    },
    /// Frame index out of range.
    #[error("the RGB-D sequence has no frame {index}; its {n_frames} frames count from 0")]
    NoSuchFrame {
        /// Requested frame index, from 0.
        index: usize,
        /// Number of frames in the sequence.
        n_frames: usize,
    },
    /// Output slice whose length is not the number of pixels.
    #[error("a slice of {found} points was given for frames of {needed}; pass as many")]
    OutputLength {
        /// Length of the output slice.
        found: usize,
        /// Number of pixels, which the slice length must equal.
        needed: usize,
    },
    /// Target folder that already holds files of a sequence.
    #[error(
        "the folder {} already holds files of an RGB-D sequence; name another",
        .0.display()
    )]
    AlreadyExists(PathBuf),
    /// Slice of a frame to be written whose length does not match the image size.
    #[error("a frame with {found} {what} cannot be written; its image needs {needed}")]
    FrameLength {
        /// Name of the slice, such as `depth`.
        what: &'static str,
        /// Length of the slice given by the caller.
        found: usize,
        /// Slice length required by the image size.
        needed: usize,
    },
    /// Invalid content of a file of the sequence.
    #[error("the file {} cannot be used: {source}", .path.display())]
    Content {
        /// Path of the invalid file.
        path: PathBuf,
        /// Error in the content of the file.
        source: ContentError,
    },
}

/// Invalid content of one file of a sequence.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContentError {
    /// Text that is not the required count of finite numbers.
    #[error("it must hold {needed} finite numbers as text and nothing else")]
    Numbers {
        /// Required count of numbers in the text.
        needed: usize,
    },
    /// Numbers that break a rule of the file, such as a matrix that is no rotation.
    #[error("{0}")]
    InvalidValue(&'static str),
    /// Impossible camera intrinsics.
    #[error("{0}")]
    Intrinsics(#[source] InvalidIntrinsics),
    /// Damaged image, or image of another size or pixel format.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Slice of the caller whose length does not match the image size.
    #[error("a slice of {found} values was given for an image that needs {needed}")]
    SliceLength {
        /// Length of the slice given by the caller.
        found: usize,
        /// Slice length required by the image size.
        needed: usize,
    },
}
