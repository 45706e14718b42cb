//! Errors of reading registered images.

use super::IntrinsicsError;
use crate::rgbd_sequence::ContentError;
use file_access::FileError;
use std::path::{Path, PathBuf};

/// Error of reading a folder of registered images.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Folder without images, or without two images of nearly the same time.
    #[error(
        "the folder {} holds no pair of images; name them 000000-color.png and \
         000000-depth.png, or rgb/000000.png and depth/000000.png, and so on",
        .0.display()
    )]
    NoFrames(PathBuf),
    /// Image whose companion of the other kind is missing.
    #[error("the image {} has no companion {missing}; add it, or remove the image", .path.display())]
    Unpaired {
        /// Path of the image that has no companion.
        path: PathBuf,
        /// Usual file name of the missing companion.
        missing: String,
    },
    /// Two images of one kind for one frame.
    #[error("{} and {} are the same image of one frame; remove one", .paths[0].display(), .paths[1].display())]
    Ambiguous {
        /// Paths of the two images.
        paths: [PathBuf; 2],
    },
    /// Images both in the folder and in its subfolders.
    #[error(
        "the folder {} holds images both in itself and in its subfolder depth; \
         give each recording its own folder",
        .0.display()
    )]
    TwoLayouts(PathBuf),
    /// Folder without intrinsics.
    #[error(
        "the folder {} holds no camera intrinsics; write its file camera.json, for example \
         {{\"width\": {}, \"height\": {}, \"fx\": 612.9, \"fy\": 613.2, \"cx\": 322.5, \
         \"cy\": 248.2, \"depth_scale\": 1}}, in pixels, and millimetres a unit of depth",
        .folder.display(), .size.0, .size.1
    )]
    NoIntrinsics {
        /// Folder of the images.
        folder: PathBuf,
        /// Columns and rows of the images.
        size: (u32, u32),
    },
    /// Unusable intrinsics.
    #[error("the intrinsics {} cannot be used: {source}", .path.display())]
    Intrinsics {
        /// Path of the file with the intrinsics.
        path: PathBuf,
        /// Error in the content of the file.
        source: IntrinsicsError,
    },
    /// Unusable image.
    #[error(
        "the image {} cannot be used: {source}; replace it, or remove it with its companion",
        .path.display()
    )]
    Image {
        /// Path of the unusable image.
        path: PathBuf,
        /// Error in the content of the image.
        source: ContentError,
    },
    /// Frame index out of range.
    #[error("there is no frame {index}; the folder's {n_frames} frames count from 0")]
    NoSuchFrame {
        /// Requested frame index, from 0.
        index: usize,
        /// Number of frames in the folder.
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
}

impl Error {
    /// Wraps an error in the content of an image with its path.
    pub(super) fn image(path: &Path) -> impl FnOnce(ContentError) -> Self {
        move |source| Self::Image {
            path: path.to_owned(),
            source,
        }
    }

    /// Wraps an error in the content of intrinsics with their path.
    pub(super) fn intrinsics(path: &Path) -> impl FnOnce(IntrinsicsError) -> Self {
        move |source| Self::Intrinsics {
            path: path.to_owned(),
            source,
        }
    }
}
