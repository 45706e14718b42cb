//! PNG images of fixed pixel formats, neither interlaced nor animated.

use crate::ImageError;
use png::{BitDepth, ColorType, DeflateCompression, Filter, Limits};
use std::io::Cursor;

/// Memory limit of the PNG decoder itself, bytes.
const MAX_DECODER_BYTES: usize = 1 << 24;

/// Maximum expansion factor of deflated PNG data.
const MAX_DEFLATE_EXPANSION: u64 = 1032;

/// Maximum number of columns or rows of an image.
pub(crate) const MAX_SIDE: u32 = 8192;

/// PNG signature.
pub(crate) const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Pixel format of an image by its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PixelKind {
    /// Depth image: one grey channel, 16 bits, millimetres.
    Depth,
    /// Instance mask: grey, 16 bits, number of the object.
    Instance,
    /// Colour image: red, green, blue, 8 bits each.
    Color,
    /// Silhouette mask: grey, 8 bits or 1, object or background.
    Silhouette,
}

impl PixelKind {
    fn color_type(self) -> ColorType {
        match self {
            Self::Color => ColorType::Rgb,
            Self::Depth | Self::Instance | Self::Silhouette => ColorType::Grayscale,
        }
    }

    /// Bits per channel when written.
    fn bit_depth(self) -> BitDepth {
        match self {
            Self::Depth | Self::Instance => BitDepth::Sixteen,
            Self::Color | Self::Silhouette => BitDepth::Eight,
        }
    }

    fn allows(self, color_type: ColorType, bit_depth: BitDepth) -> bool {
        let is_packed = self == Self::Silhouette && bit_depth == BitDepth::One;
        color_type == self.color_type() && (bit_depth == self.bit_depth() || is_packed)
    }

    /// Error sentence for an image of another format.
    fn rule(self) -> &'static str {
        match self {
            Self::Depth => "a depth image must be grey, with 16 bits a pixel, and not interlaced",
            Self::Instance => {
                "a mask of instances must be grey, with 16 bits a pixel, and not interlaced"
            }
            Self::Color => {
                "a colour image must be red, green and blue, with 24 bits a pixel, and not \
                 interlaced"
            }
            Self::Silhouette => "a mask must be grey, with 8 bits a pixel or 1, and not interlaced",
        }
    }
}

/// PNG image with a validated header.
pub(crate) struct PngImage<'a> {
    reader: png::Reader<Cursor<&'a [u8]>>,
}

impl<'a> PngImage<'a> {
    /// Opens an image and validates its header.
    pub(crate) fn open(png: &'a [u8], kind: PixelKind) -> Result<Self, ImageError> {
        let limits = Limits {
            bytes: MAX_DECODER_BYTES,
        };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(png), limits);
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let header = decoder.read_header_info()?;
        if !kind.allows(header.color_type, header.bit_depth) || header.interlaced {
            return Err(ImageError::Format(kind.rule()));
        }
        if header.width > MAX_SIDE || header.height > MAX_SIDE {
            return Err(ImageError::Format(
                "an image must have at most 8192 pixels a side",
            ));
        }
        let row_bytes = header.raw_row_length() as u64 - 1;
        if row_bytes * u64::from(header.height) > MAX_DEFLATE_EXPANSION * png.len() as u64 {
            return Err(ImageError::Format("the image is too short for its size"));
        }
        let reader = decoder.read_info()?;
        if reader.info().animation_control.is_some() || reader.info().frame_control.is_some() {
            return Err(ImageError::Format("an image must not be animated"));
        }
        Ok(Self { reader })
    }

    /// Opens an image that must have the size of a reference image.
    pub(crate) fn open_sized(
        png: &'a [u8],
        kind: PixelKind,
        needed: (u32, u32),
        reference: &'static str,
    ) -> Result<Self, ImageError> {
        let image = Self::open(png, kind)?;
        check_size(image.size(), needed, reference)?;
        Ok(image)
    }

    /// Width and height of the PNG image, pixels.
    pub(crate) fn size(&self) -> (u32, u32) {
        self.reader.info().size()
    }

    /// Decodes 16-bit values, row-major, into a buffer.
    pub(crate) fn decode_u16(self, values: &mut Vec<u16>) -> Result<(), ImageError> {
        let n_pixels = self.n_pixels();
        values.clear();
        values.reserve(n_pixels);
        self.for_each_row(|row| {
            values.extend(row.as_chunks().0.iter().copied().map(u16::from_be_bytes));
        })
    }

    /// Decodes 8-bit values, row-major, into a buffer; a 1-bit value becomes 0 or 255.
    pub(crate) fn decode_u8(self, values: &mut Vec<u8>) -> Result<(), ImageError> {
        let (width, n_pixels) = (self.size().0 as usize, self.n_pixels());
        let is_packed = self.reader.info().bit_depth == BitDepth::One;
        let n_channels = self.reader.info().color_type.samples();
        values.clear();
        values.reserve(n_channels * n_pixels);
        self.for_each_row(|row| {
            if is_packed {
                let bit = |column: usize| row[column / 8] >> (7 - column % 8) & 1;
                values.extend((0..width).map(|column| 255 * bit(column)));
            } else {
                values.extend_from_slice(row);
            }
        })
    }

    fn n_pixels(&self) -> usize {
        let (width, height) = self.size();
        width as usize * height as usize
    }

    /// Decodes row by row: for a whole image the decoder would also expand any data after the last
    /// row.
    fn for_each_row(mut self, mut visit: impl FnMut(&[u8])) -> Result<(), ImageError> {
        let mut row = vec![0; self.reader.info().raw_row_length() - 1];
        for _ in 0..self.size().1 {
            self.reader.read_row(&mut row)?;
            visit(&row);
        }
        Ok(())
    }
}

/// Checks the size of an image against that of its reference image.
pub(crate) fn check_size(
    found: (u32, u32),
    needed: (u32, u32),
    reference: &'static str,
) -> Result<(), ImageError> {
    if found == needed {
        Ok(())
    } else {
        Err(ImageError::Size {
            found,
            needed,
            reference,
        })
    }
}

/// Encodes an image and appends it to a file, fast rather than small. `samples` are the bytes
/// as PNG stores them, row-major; 16-bit values are big-endian.
pub(crate) fn encode(
    kind: PixelKind,
    size: (u32, u32),
    samples: &[u8],
    file: &mut Vec<u8>,
) -> Result<(), ImageError> {
    let mut encoder = png::Encoder::new(file, size.0, size.1);
    encoder.set_color(kind.color_type());
    encoder.set_depth(kind.bit_depth());
    // As small as level 1 of zlib, in a quarter of the time: benchmark `write_frame`.
    encoder.set_deflate_compression(DeflateCompression::FdeflateUltraFast);
    encoder.set_filter(Filter::Paeth);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    Ok(writer.finish()?)
}

/// Converts 16-bit values to big-endian bytes, as PNG stores them, into a buffer.
pub(crate) fn to_big_endian_samples(values: &[u16], samples: &mut Vec<u8>) {
    samples.clear();
    samples.extend(values.iter().flat_map(|value| value.to_be_bytes()));
}
