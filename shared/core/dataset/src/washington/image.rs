//! Image decoders of Washington views.

use crate::ContentError;
use crate::ImageError;
use crate::png_image::{PixelKind, PngImage};

/// Decodes the colour image of a view into red, green and blue bytes, row-major; returns its
/// columns and rows.
///
/// # Errors
/// When the bytes are not a colour image, or are damaged.
pub fn decode_color(png: &[u8], color: &mut Vec<u8>) -> Result<(u32, u32), ContentError> {
    let image = PngImage::open(png, PixelKind::Color)?;
    let size = image.size();
    image.decode_u8(color)?;
    Ok(size)
}

/// Decodes the depth image of a view of known size into millimetres, row-major.
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

/// Decodes the mask of a view of known size, row-major: 0 is background, any other value the
/// object.
///
/// # Errors
/// When the bytes are not a mask of that size, or are damaged.
pub fn decode_mask(png: &[u8], size: (u32, u32), mask: &mut Vec<u8>) -> Result<(), ContentError> {
    Ok(open_image(png, PixelKind::Silhouette, size)?.decode_u8(mask)?)
}

/// Opens an image that must have the size of the colour image.
fn open_image(png: &[u8], kind: PixelKind, size: (u32, u32)) -> Result<PngImage<'_>, ImageError> {
    PngImage::open_sized(png, kind, size, "the colour image of the view")
}
