//! Image decoders of RGB-D sequences.

use super::ContentError;
use crate::ImageError;
use crate::png_image::{MAX_SIDE, PixelKind, PngImage, SIGNATURE, check_size};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Maximum number of scans of a progressive JPEG image. Cameras and libraries write about ten;
/// a crafted file of a few megabytes could ask for a million.
const MAX_JPEG_SCANS: usize = 64;

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

/// Decodes a JPEG image in colour. The size is checked before memory is reserved for pixels.
fn decode_jpeg(jpeg: &[u8], size: (u32, u32)) -> Result<Vec<u8>, ImageError> {
    let n_scans = jpeg.windows(2).filter(|pair| *pair == [0xff, 0xda]).count();
    if n_scans > MAX_JPEG_SCANS {
        return Err(ImageError::Format(
            "a colour image must not have more than 64 scans",
        ));
    }
    // Strict: a truncated image is an error, not an image with a grey rest.
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(MAX_SIDE as usize)
        .set_max_height(MAX_SIDE as usize)
        .jpeg_set_max_scans(MAX_JPEG_SCANS)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(jpeg), options);
    decoder.decode_headers()?;
    let Some(info) = decoder.info() else {
        return Err(ImageError::Format("the colour image has no header"));
    };
    check_size(
        (u32::from(info.width), u32::from(info.height)),
        size,
        REFERENCE,
    )?;
    if info.components != 3 {
        return Err(ImageError::Format(
            "a colour image must have 24 bits a pixel",
        ));
    }
    Ok(decoder.decode()?)
}

/// Opens a PNG image that must have the size of the sequence.
fn open_png(png: &[u8], kind: PixelKind, size: (u32, u32)) -> Result<PngImage<'_>, ImageError> {
    PngImage::open_sized(png, kind, size, REFERENCE)
}
