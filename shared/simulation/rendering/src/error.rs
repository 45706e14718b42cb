//! What can go wrong with an input.

use geometry::InvalidIntrinsics;
use std::fmt;

/// Why nothing could be rendered or measured.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The camera's intrinsics can not be those of a camera.
    Camera(InvalidIntrinsics),
    /// The camera's pose has a number that is not finite.
    Pose,
    /// The caller's buffer does not have the image's size.
    CloudSize {
        /// Points in the buffer.
        n_points: usize,
        /// Pixels of the image.
        n_pixels: usize,
    },
    /// The image was not rendered with the sensor's camera.
    ForeignImage,
    /// A parameter of the sensor's model is out of its range.
    SensorModel {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f32,
        /// Least value allowed.
        min: f32,
        /// Greatest value allowed.
        max: f32,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Camera(_) => write!(f, "nothing can be rendered without a valid camera"),
            Self::Pose => write!(
                f,
                "the camera's pose has a number that is not finite; give a rigid transform"
            ),
            Self::CloudSize { n_points, n_pixels } => write!(
                f,
                "a buffer of {n_points} points can not take an image of {n_pixels} pixels; \
                 give one point for each pixel"
            ),
            Self::ForeignImage => write!(
                f,
                "the image was rendered with another camera than the sensor's; \
                 make both from the same intrinsics"
            ),
            Self::SensorModel {
                name,
                value,
                min,
                max,
            } => write!(
                f,
                "the sensor parameter {name} is {value} but must lie between {min} and {max}"
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Camera(invalid) => Some(invalid),
            _ => None,
        }
    }
}

impl From<InvalidIntrinsics> for Error {
    fn from(invalid: InvalidIntrinsics) -> Self {
        Self::Camera(invalid)
    }
}
