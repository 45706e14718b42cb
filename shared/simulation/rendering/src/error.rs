//! Errors of the renderer and the sensor model.

use geometry::InvalidIntrinsics;
use value_range::OutOfRange;

/// Rejected input of the renderer or the sensor model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The camera intrinsics are invalid.
    #[error("nothing can be rendered without a valid camera")]
    Camera(#[from] InvalidIntrinsics),
    /// Camera pose with a number that is not finite.
    #[error("the camera's pose has a number that is not finite; give a rigid transform")]
    Pose,
    /// Point buffer whose size is not that of the image.
    #[error(
        "a buffer of {n_points} points cannot take an image of {n_pixels} pixels; \
         give one point for each pixel"
    )]
    CloudSize {
        /// Number of points in the caller's buffer.
        n_points: usize,
        /// Number of pixels of the image.
        n_pixels: usize,
    },
    /// Image rendered with a camera other than the sensor's.
    #[error(
        "the image was rendered with another camera than the sensor's; \
         make both from the same intrinsics"
    )]
    ForeignImage,
    /// Sensor model parameter outside of its range.
    #[error("the sensor parameter {0}")]
    SensorModel(#[from] OutOfRange<f32>),
}
