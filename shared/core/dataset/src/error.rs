//! Errors of reading and writing recordings and datasets of views.

use crate::registered_images::IntrinsicsError;
use crate::{ImageError, RecordingKind, pcd};
use file_access::FileError;
use geometry::InvalidIntrinsics;
use std::path::{Path, PathBuf};

/// Error of a folder with a recording or with views of objects, or of one of its files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Path that is not a folder.
    #[error("{} is not a folder; name the folder that holds the recording", .0.display())]
    NotAFolder(PathBuf),
    /// Folder without entries.
    #[error("the folder {} is empty; name one with a recording", .0.display())]
    Empty(PathBuf),
    /// Folder without files of a known recording.
    #[error(
        "the folder {} holds no recording; a recording is {}, {}, {} or {}",
        .0.display(),
        RecordingKind::PcdScenes,
        RecordingKind::RgbdSequence,
        RecordingKind::RegisteredImages,
        RecordingKind::Fakenect
    )]
    Unknown(PathBuf),
    /// Folder with files of several kinds of recording.
    #[error(
        "the folder {} holds both {} and {}; give each its own folder",
        .path.display(), .kinds[0], .kinds[1]
    )]
    Mixed {
        /// Path of the recording's folder.
        path: PathBuf,
        /// Two of the kinds found.
        kinds: [RecordingKind; 2],
    },
    /// Folder without PCD files.
    #[error("the folder {} holds no scenes; their names end in .pcd", .0.display())]
    NoScenes(PathBuf),
    /// Folder without depth images of an RGB-D sequence.
    #[error(
        "the folder {} holds no frames of an RGB-D sequence; they are called \
         frame-000000.depth.png and so on",
        .0.display()
    )]
    NoFrames(PathBuf),
    /// Folder without images, or without two images of nearly the same time.
    #[error(
        "the folder {} holds no pair of images; name them 000000-color.png and \
         000000-depth.png, or rgb/000000.png and depth/000000.png, and so on",
        .0.display()
    )]
    NoPairs(PathBuf),
    /// Folder without files in the Washington layout.
    #[error(
        "the folder {} holds no views of objects; they are called apple_1_1_1_crop.png \
         and so on",
        .0.display()
    )]
    NoCrops(PathBuf),
    /// Folder without object views in any layout.
    #[error(
        "the folder {} holds no views of objects; it needs a folder of PCD files for each \
         category, or the layout of the Washington RGB-D Object Dataset",
        .0.display()
    )]
    NoViews(PathBuf),
    /// Object view without a single point with depth.
    #[error("the view {} has no point with depth; leave it out", .0.display())]
    NoPoints(PathBuf),
    /// Dataset with more views or folders than the limits.
    #[error(
        "the folder {} holds more than a million views or 65536 folders; split it",
        .0.display()
    )]
    TooLarge(PathBuf),
    /// File of a view that is in several folders.
    #[error("the file {} is in another folder, too; remove one of them", .0.display())]
    Duplicate(PathBuf),
    /// Image whose companion of the other kind is missing.
    #[error("the image {} has no companion {missing}; add it, or remove the image", .path.display())]
    Unpaired {
        /// Path of the image that has no companion.
        path: PathBuf,
        /// Usual file name of the missing companion, or a clause about its ending.
        missing: String,
    },
    /// Two images of one frame with the same role.
    #[error("{} and {} are the same image of one frame; remove one", .paths[0].display(), .paths[1].display())]
    Ambiguous {
        /// Paths of both images.
        paths: [PathBuf; 2],
    },
    /// Images in both layouts.
    #[error(
        "the folder {} holds images both in itself and in its subfolder depth; \
         give each recording its own folder",
        .0.display()
    )]
    TwoLayouts(PathBuf),
    /// Folder without a file of intrinsics.
    #[error(
        "the folder {} holds no camera intrinsics; write its file camera.json, for example \
         {{\"width\": {}, \"height\": {}, \"fx\": 612.9, \"fy\": 613.2, \"cx\": 322.5, \
         \"cy\": 248.2, \"depth_scale\": 1}}, in pixels, and millimetres a unit of depth",
        .folder.display(), .size.0, .size.1
    )]
    NoIntrinsics {
        /// Path of the image folder.
        folder: PathBuf,
        /// Width and height of the images, pixels.
        size: (u32, u32),
    },
    /// Invalid file with intrinsics.
    #[error("the intrinsics {} cannot be used: {source}", .path.display())]
    Intrinsics {
        /// Path of the file.
        path: PathBuf,
        /// Error in the content of the file.
        source: IntrinsicsError,
    },
    /// Invalid image of a pair.
    #[error(
        "the image {} cannot be used: {source}; replace it, or remove it with its companion",
        .path.display()
    )]
    Image {
        /// Path of the image.
        path: PathBuf,
        /// Error in the content of the image.
        source: ContentError,
    },
    /// Invalid content of a file.
    #[error("the file {} cannot be used: {source}", .path.display())]
    Content {
        /// Path of the invalid file.
        path: PathBuf,
        /// Error in the content of the file.
        source: ContentError,
    },
    /// Index of a scene, frame or view out of range.
    #[error("there is no {what} {index}; the folder's {n} {what}s count from 0")]
    NoSuch {
        /// Kind of the requested thing.
        what: &'static str,
        /// Requested index, from 0.
        index: usize,
        /// Number of these things in the folder.
        n: usize,
    },
    /// View without the requested images or points.
    #[error("the view {name} of the data set has no {what}; request the part that it has")]
    MissingPart {
        /// Name of the Washington view.
        name: String,
        /// Missing part of the dataset: `images` or `points`.
        what: &'static str,
    },
    /// Output slice of the caller whose length is not the number of pixels.
    #[error("a slice of {found} points was given for frames of {needed}; pass as many")]
    OutputLength {
        /// Length of the slice given by the caller.
        found: usize,
        /// Number of points of a frame.
        needed: usize,
    },
    /// Array of the caller whose length does not match the image size.
    #[error("a frame or view with {found} {what} cannot be used; its size needs {needed}")]
    Length {
        /// Name of the array, such as `depths`.
        what: &'static str,
        /// Length of the array.
        found: usize,
        /// Array length required by the image size.
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
    /// Output folder that already contains a sequence.
    #[error("the folder {} already holds files of an RGB-D sequence; name another", .0.display())]
    SequenceExists(PathBuf),
    /// View to be written that already exists.
    #[error("the view {} is already there; give the new one another number", .0.display())]
    ViewExists(PathBuf),
}

impl Error {
    /// Error about the content of a file.
    pub(crate) fn content(path: &Path) -> impl FnOnce(ContentError) -> Self {
        move |source| Self::Content {
            path: path.to_owned(),
            source,
        }
    }

    /// Error about an image of a pair.
    pub(crate) fn image(path: &Path) -> impl FnOnce(ContentError) -> Self {
        move |source| Self::Image {
            path: path.to_owned(),
            source,
        }
    }

    /// Error about a file with intrinsics.
    pub(crate) fn intrinsics(path: &Path) -> impl FnOnce(IntrinsicsError) -> Self {
        move |source| Self::Intrinsics {
            path: path.to_owned(),
            source,
        }
    }
}

/// Invalid content of one file of a recording or view.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContentError {
    /// Text that does not consist of the required numbers.
    #[error("it must hold {needed} finite numbers as text and nothing else")]
    Numbers {
        /// Number of values that the text must contain.
        needed: usize,
    },
    /// Numbers that cannot be what they stand for; the broken rule as a sentence.
    #[error("{0}")]
    InvalidValue(&'static str),
    /// Matrix that is not that of a pinhole camera.
    #[error("{0}")]
    Intrinsics(#[source] InvalidIntrinsics),
    /// Text that is not the column and row of a crop.
    #[error("it must hold a column and a row from 1 to 8192, such as 272,183")]
    Location,
    /// Damaged image, or image of another size or pixel format.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Slice of the caller whose length does not match the image size.
    #[error("a slice of {found} values was given for an image that needs {needed}")]
    SliceLength {
        /// Length of the slice given by the caller.
        found: usize,
        /// Length required by the image size.
        needed: usize,
    },
    /// Invalid PCD file.
    #[error("{0}")]
    Cloud(#[from] pcd::Error),
}
