//! What can be wrong with an RGB-D sequence.

use crate::FileError;
use crate::png_image::PngError;
use geometry::InvalidIntrinsics;
use std::fmt;
use std::path::PathBuf;

/// Why an RGB-D sequence could not be read or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file or the folder could not be read or written.
    File(FileError),
    /// The folder has no depth images.
    NoFrames(PathBuf),
    /// An image lacks the other of its pair.
    Unpaired {
        /// The image that is there.
        path: PathBuf,
        /// The suffix of the one that is not.
        missing: &'static str,
    },
    /// There are not as many frames.
    NoSuchFrame {
        /// The frame that was asked for, from 0.
        index: usize,
        /// How many there are.
        n_frames: usize,
    },
    /// The slice for the points does not fill the image.
    OutputLength {
        /// Its length.
        found: usize,
        /// The length it must have.
        needed: usize,
    },
    /// The folder for a new sequence holds files of one.
    AlreadyThere(PathBuf),
    /// A frame for writing does not fill the image.
    FrameLength {
        /// Which of its slices.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        needed: usize,
    },
    /// The content of a file is wrong.
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ContentError,
    },
}

/// What is wrong inside one file of a sequence.
#[derive(Debug)]
#[non_exhaustive]
pub enum ContentError {
    /// A text file does not hold these numbers and no others.
    Numbers {
        /// How many there must be.
        needed: usize,
    },
    /// The numbers of a text file do not mean what they must.
    Meaning(&'static str),
    /// The intrinsics are not those of a camera.
    Intrinsics(InvalidIntrinsics),
    /// A PNG image can not be decoded.
    Png(png::DecodingError),
    /// A PNG image can not be encoded.
    Encoding(png::EncodingError),
    /// A colour image can not be decoded.
    Jpeg(jpeg_decoder::Error),
    /// An image is of another kind than a sequence has.
    ImageKind(&'static str),
    /// An image does not have the size of the first depth image.
    ImageSize {
        /// Its columns and rows.
        found: (u32, u32),
        /// The columns and rows of the first depth image.
        needed: (u32, u32),
    },
    /// A slice of the caller does not fill the image.
    SliceLength {
        /// Its length.
        found: usize,
        /// The length it must have.
        needed: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NoFrames(folder) => write!(
                f,
                "the folder {} holds no frames of an RGB-D sequence; they are called \
                 frame-000000.depth.png and so on",
                folder.display()
            ),
            Self::Unpaired { path, missing } => write!(
                f,
                "the image {} has no companion that ends in {missing}; add or remove one",
                path.display()
            ),
            Self::NoSuchFrame { index, n_frames } => write!(
                f,
                "the RGB-D sequence has no frame {index}; its {n_frames} frames count from 0"
            ),
            Self::OutputLength { found, needed } => write!(
                f,
                "a slice of {found} points was given for frames of {needed}; pass as many"
            ),
            Self::AlreadyThere(folder) => write!(
                f,
                "the folder {} already holds files of an RGB-D sequence; name another",
                folder.display()
            ),
            Self::FrameLength {
                what,
                found,
                needed,
            } => write!(
                f,
                "a frame with {found} {what} can not be written; its image needs {needed}"
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
            Self::Numbers { needed } => {
                write!(
                    f,
                    "it must hold {needed} finite numbers as text and nothing else"
                )
            }
            Self::Meaning(problem) | Self::ImageKind(problem) => f.write_str(problem),
            Self::Intrinsics(error) => error.fmt(f),
            Self::Png(error) => write!(f, "the PNG image is damaged: {error}"),
            Self::Encoding(error) => write!(f, "the PNG image can not be made: {error}"),
            Self::Jpeg(error) => write!(f, "the JPEG image is damaged: {error}"),
            Self::ImageSize { found, needed } => write!(
                f,
                "the image has {}x{} pixels, and the sequence's first depth image {}x{}",
                found.0, found.1, needed.0, needed.1
            ),
            Self::SliceLength { found, needed } => write!(
                f,
                "a slice of {found} values was given for an image that needs {needed}"
            ),
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
            Self::Intrinsics(error) => Some(error),
            Self::Png(error) => Some(error),
            Self::Encoding(error) => Some(error),
            Self::Jpeg(error) => Some(error),
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

impl From<jpeg_decoder::Error> for ContentError {
    fn from(error: jpeg_decoder::Error) -> Self {
        Self::Jpeg(error)
    }
}
