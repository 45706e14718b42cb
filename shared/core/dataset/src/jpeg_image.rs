//! JPEG images, decoded to red, green and blue.

use crate::ImageError;
use crate::png_image::MAX_SIDE;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Maximum number of scans of a progressive JPEG image. Cameras and libraries write about ten;
/// a crafted file of a few megabytes could ask for a million.
const MAX_JPEG_SCANS: usize = 64;

/// Header of a JPEG image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JpegHeader {
    /// Width and height, pixels.
    pub(crate) size: (u32, u32),
    /// Number of channels of the file: 1 for grey, 3 for colour.
    pub(crate) n_channels: u8,
}

/// Decodes a JPEG image into red, green and blue bytes, row-major. The header is checked before
/// memory is reserved for pixels.
pub(crate) fn decode(
    jpeg: &[u8],
    check: impl FnOnce(JpegHeader) -> Result<(), ImageError>,
) -> Result<(JpegHeader, Vec<u8>), ImageError> {
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
    let header = JpegHeader {
        size: (u32::from(info.width), u32::from(info.height)),
        n_channels: info.components,
    };
    check(header)?;
    Ok((header, decoder.decode()?))
}
