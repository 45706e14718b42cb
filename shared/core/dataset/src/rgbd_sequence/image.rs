//! Image decoders of RGB-D sequences.

use crate::ContentError;
use crate::ImageError;
use crate::jpeg_image;
use crate::png_image::{PixelKind, PngImage, SIGNATURE, check_size};

/// Image that gives all images of a sequence their size, as named in errors.
const REFERENCE: &str = "the sequence's first depth image";

/// Reads columns and rows of a depth image.
///
/// # Errors
/// When the bytes are not a depth image.
pub fn depth_image_size(png: &[u8]) -> Result<(u32, u32), ContentError> {
    Ok(PngImage::open(png, PixelKind::Depth)?.size())
}

/// Decodes a depth image of known size into millimetres, row-major.
///
/// # Errors
/// When the bytes are not a depth image of that size, or are damaged.
pub fn decode_depth(
    png: &[u8],
    size: (u32, u32),
    depth_mm: &mut Vec<u16>,
) -> Result<(), ContentError> {
    Ok(open_png(png, PixelKind::Depth, size)?.decode_u16(depth_mm)?)
}

/// Decodes an instance mask of known size: number of each pixel's object, row-major; 0 is
/// background.
///
/// # Errors
/// When the bytes are not a mask of that size, or are damaged.
pub fn decode_mask(
    png: &[u8],
    size: (u32, u32),
    instances: &mut Vec<u16>,
) -> Result<(), ContentError> {
    Ok(open_png(png, PixelKind::Instance, size)?.decode_u16(instances)?)
}

/// Decodes a colour image of known size, PNG or JPEG by its signature, into red, green and blue
/// bytes, row-major.
///
/// *Allocation*: the result, and what the decoder needs for itself.
///
/// # Errors
/// When the bytes are not an image in colour of that size, or are damaged.
pub fn decode_color(bytes: &[u8], size: (u32, u32)) -> Result<Vec<u8>, ContentError> {
    if bytes.starts_with(&SIGNATURE) {
        let mut color = Vec::new();
        open_png(bytes, PixelKind::Color, size)?.decode_u8(&mut color)?;
        return Ok(color);
    }
    Ok(decode_jpeg(bytes, size)?)
}

/// Decodes a JPEG image in colour.
fn decode_jpeg(jpeg: &[u8], size: (u32, u32)) -> Result<Vec<u8>, ImageError> {
    let (_, color) = jpeg_image::decode(jpeg, |header| {
        check_size(header.size, size, REFERENCE)?;
        if header.n_channels == 3 {
            Ok(())
        } else {
            Err(ImageError::Format(
                "a colour image must have 24 bits a pixel",
            ))
        }
    })?;
    Ok(color)
}

/// Opens a PNG image that must have the size of the sequence.
fn open_png(png: &[u8], kind: PixelKind, size: (u32, u32)) -> Result<PngImage<'_>, ImageError> {
    PngImage::open_sized(png, kind, size, REFERENCE)
}
