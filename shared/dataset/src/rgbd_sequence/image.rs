//! The images of a sequence.

use super::ContentError;
use jpeg_decoder::PixelFormat;
use png::{BitDepth, ColorType, Limits};
use std::io::Cursor;

/// Most bytes a PNG decoder may take for itself.
const MAX_PNG_BYTES: usize = 1 << 24;

/// How much longer than itself deflated data can become.
const MAX_DEFLATE_EXPANSION: u64 = 1032;

/// Most columns or rows of an image.
const MAX_SIDE: u32 = 8192;

/// Most passes over a progressive JPEG image. Cameras and libraries write
/// about ten; a crafted file of a few megabytes could ask for a million.
const MAX_JPEG_SCANS: usize = 64;

type PngReader<'a> = png::Reader<Cursor<&'a [u8]>>;

/// Columns and rows of a depth image.
///
/// # Errors
/// When the bytes are not a depth image.
pub fn depth_image_size(png: &[u8]) -> Result<(u32, u32), ContentError> {
    Ok(open_depth(png)?.info().size())
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
    let mut reader = open_depth(png)?;
    check_size(reader.info().size(), size)?;
    let row_bytes = 2 * size.0 as usize;
    let mut row = vec![0; row_bytes];
    depth_mm.clear();
    depth_mm.reserve(size.0 as usize * size.1 as usize);
    // Row by row, since the decoder would expand whatever follows the last row
    // if it were asked for the whole image.
    for _ in 0..size.1 {
        reader.read_row(&mut row)?;
        depth_mm.extend(row.as_chunks().0.iter().copied().map(u16::from_be_bytes));
    }
    Ok(())
}

fn open_depth(png: &[u8]) -> Result<PngReader<'_>, ContentError> {
    let limits = Limits {
        bytes: MAX_PNG_BYTES,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(png), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info()?;
    let is_depth = header.color_type == ColorType::Grayscale
        && header.bit_depth == BitDepth::Sixteen
        && !header.interlaced;
    if !is_depth {
        return Err(ContentError::ImageKind(
            "a depth image must be grey, with 16 bits a pixel, and not interlaced",
        ));
    }
    if header.width > MAX_SIDE || header.height > MAX_SIDE {
        return Err(ContentError::ImageKind(
            "an image must have at most 8192 pixels a side",
        ));
    }
    let n_bytes = 2 * u64::from(header.width) * u64::from(header.height);
    if n_bytes > MAX_DEFLATE_EXPANSION * png.len() as u64 {
        return Err(ContentError::ImageKind(
            "the depth image is too short for its size",
        ));
    }
    let reader = decoder.read_info()?;
    if reader.info().animation_control.is_some() || reader.info().frame_control.is_some() {
        return Err(ContentError::ImageKind(
            "a depth image must not be animated",
        ));
    }
    Ok(reader)
}

/// Decodes a colour image of a known size into red, green and blue bytes, row
/// by row.
///
/// *Allocation*: the result, and what the decoder needs for itself.
///
/// # Errors
/// When the bytes are not a JPEG image in colour of that size, or are damaged.
pub fn decode_color(jpeg: &[u8], size: (u32, u32)) -> Result<Vec<u8>, ContentError> {
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

fn check_size(found: (u32, u32), needed: (u32, u32)) -> Result<(), ContentError> {
    if found == needed {
        Ok(())
    } else {
        Err(ContentError::ImageSize { found, needed })
    }
}
