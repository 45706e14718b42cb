//! Camera intrinsics in JSON, in the layouts of BOP, `Open3D`, `RealSense` and ROS.

use crate::ContentError;
use geometry::{InvalidIntrinsics, PinholeCamera};
use serde::Deserialize;
use std::ops::RangeInclusive;

/// Valid units of depth, millimetres. Cameras have 0.1 to 1; a scale to metres or from metres,
/// 0.001 or 1000, falls outside.
const DEPTH_UNITS_MM: RangeInclusive<f64> = 0.01..=10.0;

/// Longest quotation of an error of the JSON parser, characters.
const MAX_QUOTED: usize = 160;

/// Camera of registered images: intrinsics and unit of depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthCamera {
    /// Intrinsics of both images.
    pub camera: PinholeCamera,
    /// Unit of the depth images, millimetres.
    pub depth_unit_mm: f64,
}

/// Error in the content of a file with intrinsics.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IntrinsicsError {
    /// Text that is not JSON of a known layout.
    #[error("it is not JSON with intrinsics: {}", quoted(.0))]
    Json(#[from] serde_json::Error),
    /// Object without a focal length or principal point.
    #[error("it has no {0}; write fx, fy, cx and cy, in pixels")]
    Missing(&'static str),
    /// Matrix that is not one of a pinhole camera.
    #[error("{name} must be the matrix fx 0 cx, 0 fy cy, 0 0 1, {order}")]
    NotPinhole {
        /// Key of the matrix.
        name: &'static str,
        /// Order of the matrix in the file.
        order: &'static str,
    },
    /// Intrinsics of images of another size.
    #[error(
        "it is for images of {} x {} pixels, and the images have {} x {}; write the \
         intrinsics of this size",
        .found[0], .found[1], .needed.0, .needed.1
    )]
    OtherSize {
        /// Columns and rows in the file; the value of the images where it has none.
        found: [u32; 2],
        /// Columns and rows of the images.
        needed: (u32, u32),
    },
    /// Unit of depth outside the valid range.
    #[error(
        "depth_scale {0} must lie between 0.01 and 10; it is millimetres a unit of depth, \
         1 for most cameras"
    )]
    DepthUnit(f64),
    /// Impossible camera intrinsics.
    #[error("{0}")]
    Impossible(#[from] InvalidIntrinsics),
    /// Unusable matrix as text.
    #[error(transparent)]
    Matrix(ContentError),
}

/// Intrinsics as written in JSON; unknown keys are ignored.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct RawIntrinsics {
    fx: Option<f64>,
    fy: Option<f64>,
    #[serde(alias = "x_offset", alias = "ppx")]
    cx: Option<f64>,
    #[serde(alias = "y_offset", alias = "ppy")]
    cy: Option<f64>,
    #[serde(alias = "img_width")]
    width: Option<u32>,
    #[serde(alias = "img_height")]
    height: Option<u32>,
    /// Column-major, as `Open3D` writes it.
    intrinsic_matrix: Option<[f64; 9]>,
    /// Row-major, as ROS and BOP write it.
    #[serde(rename = "K", alias = "k", alias = "cam_K")]
    calibration_matrix: Option<[f64; 9]>,
    depth_scale: Option<f64>,
}

/// Parses intrinsics in JSON for images of a given size.
///
/// | keys | written by |
/// |---|---|
/// | `fx`, `fy`, `cx`, `cy` | BOP and many others; preferred |
/// | `fx`, `fy`, `x_offset`, `y_offset`; `ppx`, `ppy` | `RealSense` tools |
/// | `intrinsic_matrix`: 9 numbers, column-major | `Open3D` |
/// | `K` or `cam_K`: 9 numbers, row-major | ROS, BOP |
/// | optional: `width`, `height`; `img_width`, `img_height` | must be the images' size |
/// | optional: `depth_scale` | BOP: millimetres a unit of depth, 1 if not given |
///
/// # Errors
/// When the text is not such an object, a number is missing or no camera has it, or the
/// intrinsics are for images of another size.
pub fn parse_intrinsics_json(
    bytes: &[u8],
    size: (u32, u32),
) -> Result<DepthCamera, IntrinsicsError> {
    let raw: RawIntrinsics = serde_json::from_slice(bytes)?;
    let found = [raw.width.unwrap_or(size.0), raw.height.unwrap_or(size.1)];
    if found != [size.0, size.1] {
        return Err(IntrinsicsError::OtherSize {
            found,
            needed: size,
        });
    }
    let depth_unit_mm = raw.depth_scale.unwrap_or(1.0);
    if !DEPTH_UNITS_MM.contains(&depth_unit_mm) {
        return Err(IntrinsicsError::DepthUnit(depth_unit_mm));
    }
    Ok(DepthCamera {
        camera: PinholeCamera::with_intrinsics(raw.numbers()?, size.into())?,
        depth_unit_mm,
    })
}

impl RawIntrinsics {
    /// fx, fy, cx and cy: single numbers are preferred to a matrix.
    fn numbers(&self) -> Result<[f64; 4], IntrinsicsError> {
        let single = [self.fx, self.fy, self.cx, self.cy];
        if single.iter().all(Option::is_none) {
            if let Some([fx, c1, c2, skew, fy, c5, cx, cy, one]) = self.intrinsic_matrix {
                let form = [c1, c2, skew, c5, one];
                return pinhole(
                    "intrinsic_matrix",
                    "column by column",
                    [fx, fy, cx, cy],
                    form,
                );
            }
            if let Some([fx, skew, cx, r1, fy, cy, r3, r4, one]) = self.calibration_matrix {
                let form = [skew, r1, r3, r4, one];
                return pinhole("K", "row by row", [fx, fy, cx, cy], form);
            }
        }
        let mut numbers = [0.0; 4];
        for ((number, value), name) in numbers.iter_mut().zip(single).zip(["fx", "fy", "cx", "cy"])
        {
            *number = value.ok_or(IntrinsicsError::Missing(name))?;
        }
        Ok(numbers)
    }
}

/// Intrinsics of a matrix whose other elements have the form of a pinhole camera.
fn pinhole(
    name: &'static str,
    order: &'static str,
    numbers: [f64; 4],
    form: [f64; 5],
) -> Result<[f64; 4], IntrinsicsError> {
    if form == [0.0, 0.0, 0.0, 0.0, 1.0] {
        Ok(numbers)
    } else {
        Err(IntrinsicsError::NotPinhole { name, order })
    }
}

/// Message of the JSON parser, shortened: it quotes the text.
fn quoted(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let is_printable = |character: &char| !character.is_control();
    text.chars().filter(is_printable).take(MAX_QUOTED).collect()
}
