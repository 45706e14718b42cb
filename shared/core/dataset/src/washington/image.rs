//! The images of a view.

use super::error::ContentError;
use crate::png_image::{PixelKind, PngImage};

/// Decodes the colour image of a view into red, green and blue bytes, row by
/// row, and returns its columns and rows.
///
/// # Errors
/// When the bytes are not a colour image, or are damaged.
pub fn decode_color(png: &[u8], color: &mut Vec<u8>) -> Result<(u32, u32), ContentError> {
    let image = PngImage::open(png, PixelKind::Color)?;
    let size = image.size();
    image.decode_u8(color)?;
    Ok(size)
}

/// Decodes the depth image of a view of known size into millimetres, row by
/// row.
///
/// # Errors
/// When the bytes are not a depth image of that size, or are damaged.
pub fn decode_depth(
    png: &[u8],
    size: (u32, u32),
    depth_mm: &mut Vec<u16>,
) -> Result<(), ContentError> {
    Ok(open_image(png, PixelKind::Depth, size)?.decode_u16(depth_mm)?)
}

/// Decodes the mask of a view of known size, row by row: 0 beside the object,
/// anything else on it.
///
/// # Errors
/// When the bytes are not a mask of that size, or are damaged.
pub fn decode_mask(png: &[u8], size: (u32, u32), mask: &mut Vec<u8>) -> Result<(), ContentError> {
    Ok(open_image(png, PixelKind::Silhouette, size)?.decode_u8(mask)?)
}

/// Opens an image that must have this size.
fn open_image(
    png: &[u8],
    kind: PixelKind,
    needed: (u32, u32),
) -> Result<PngImage<'_>, ContentError> {
    let image = PngImage::open(png, kind)?;
    let found = image.size();
    if found == needed {
        Ok(image)
    } else {
        Err(ContentError::ImageSize { found, needed })
    }
}
