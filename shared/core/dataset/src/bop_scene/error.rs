//! Error of reading or writing a BOP scene.

use crate::image_error::ImageError;
use crate::ply;
use file_access::FileError;
use std::path::PathBuf;

/// Error of reading or writing a BOP scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Failed access to a file or folder.
    #[error("{0}")]
    File(#[from] FileError),
    /// Text that is not the expected JSON.
    #[error("the file {} is not as in the BOP format: {source}", .path.display())]
    Json {
        /// Path of the file.
        path: PathBuf,
        /// Error of the parser.
        source: serde_json::Error,
    },
    /// Image whose annotation breaks a rule.
    #[error("image {image} of the BOP scene {}: {rule}", .folder.display())]
    Annotation {
        /// Folder of the scene.
        folder: PathBuf,
        /// Number of the image, or its key where that is no number.
        image: String,
        /// Broken rule.
        rule: &'static str,
    },
    /// Scene without images.
    #[error("the BOP scene {} has no images; scene_camera.json lists none", .0.display())]
    NoImages(PathBuf),
    /// Image or object index out of range.
    #[error("there is no {what} {index} in the BOP scene; they count from 0 to {last}")]
    NoSuch {
        /// Kind of the requested thing.
        what: &'static str,
        /// Requested index.
        index: usize,
        /// Greatest index.
        last: usize,
    },
    /// Image file that cannot be decoded.
    #[error("the image {} is unusable: {source}", .path.display())]
    Image {
        /// Path of the image.
        path: PathBuf,
        /// Error of the decoder.
        source: ImageError,
    },
    /// Depth image in a format that is not read.
    #[error(
        "the depth image {} is a TIFF; convert it to a grey PNG of 16 bits, and name its unit as \
         depth_scale in scene_camera.json",
        .0.display()
    )]
    DepthFormat(PathBuf),
    /// Model file that cannot be read or written.
    #[error("the model {} is unusable: {source}", .path.display())]
    Model {
        /// Path of the model.
        path: PathBuf,
        /// Error of the reader.
        source: ply::Error,
    },
}
