//! The images of a sequence.

use super::ContentError;
use crate::png_image::{PixelKind, PngImage, SIGNATURE};
use jpeg_decoder::PixelFormat;

/// Most passes over a progressive JPEG image. Cameras and libraries write
/// about ten; a crafted file of a few megabytes could ask for a million.
const MAX_JPEG_SCANS: usize = 64;

/// Columns and rows of a depth image.
///
/// # Errors
/// When the bytes are not a depth image.
pub fn depth_image_size(png: &[u8]) -> Result<(u32, u32), ContentError> {
    Ok(PngImage::open(png, PixelKind::Depth)?.size())
}

/// Decodes a depth image of a known size into millimetres, row by row.
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

/// Decodes a mask of a known size into the number of each pixel's object, row
/// by row; 0 is none.
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

/// Decodes a colour image of a known size, PNG or JPEG by how it begins, into
/// red, green and blue bytes, row by row.
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
    decode_jpeg(bytes, size)
}

fn decode_jpeg(jpeg: &[u8], size: (u32, u32)) -> Result<Vec<u8>, ContentError> {
    let n_scans = jpeg.windows(2).filter(|pair| *pair == [0xff, 0xda]).count();
    if n_scans > MAX_JPEG_SCANS {
        return Err(ContentError::ImageKind(
            "a colour image must not have more than 64 scans",
        ));
    }
    let mut decoder = jpeg_decoder::Decoder::new(jpeg);
    decoder.set_max_decoding_buffer_size(3 * size.0 as usize * size.1 as usize);
    decoder.read_info()?;
    let Some(info) = decoder.info() else {
        return Err(ContentError::ImageKind("the colour image has no header"));
    };
    check_size((u32::from(info.width), u32::from(info.height)), size)?;
    if info.pixel_format != PixelFormat::RGB24 {
        return Err(ContentError::ImageKind(
            "a colour image must have 24 bits a pixel",
        ));
    }
    Ok(decoder.decode()?)
}

/// Opens an image that must have this size.
fn open_png(png: &[u8], kind: PixelKind, needed: (u32, u32)) -> Result<PngImage<'_>, ContentError> {
    let image = PngImage::open(png, kind)?;
    check_size(image.size(), needed)?;
    Ok(image)
}

fn check_size(found: (u32, u32), needed: (u32, u32)) -> Result<(), ContentError> {
    if found == needed {
        Ok(())
    } else {
        Err(ContentError::ImageSize { found, needed })
    }
}
