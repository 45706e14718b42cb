//! PNG images of one kind of pixel, neither interlaced nor animated.

use png::{BitDepth, ColorType, DeflateCompression, Filter, Limits};
use std::io::Cursor;

/// Most bytes a PNG decoder may take for itself.
const MAX_DECODER_BYTES: usize = 1 << 24;

/// How much longer than itself deflated data can become.
const MAX_DEFLATE_EXPANSION: u64 = 1032;

/// Most columns or rows of an image.
pub(crate) const MAX_SIDE: u32 = 8192;

/// How a PNG file begins.
pub(crate) const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// What an image shows, and so how its pixels are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PixelKind {
    /// Grey, 16 bits: millimetres.
    Depth,
    /// Grey, 16 bits: number of an object.
    Instance,
    /// Red, green, blue, 8 bits each.
    Color,
    /// Grey, 8 bits or 1: object or not.
    Silhouette,
}

impl PixelKind {
    fn color_type(self) -> ColorType {
        match self {
            Self::Color => ColorType::Rgb,
            Self::Depth | Self::Instance | Self::Silhouette => ColorType::Grayscale,
        }
    }

    /// Bits of a channel when written.
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

    /// The sentence about an image of another kind.
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

/// Why an image can not be decoded.
#[derive(Debug)]
pub(crate) enum PngError {
    /// The file is damaged.
    Decoding(png::DecodingError),
    /// It is an image of another kind.
    Kind(&'static str),
}

impl From<png::DecodingError> for PngError {
    fn from(error: png::DecodingError) -> Self {
        Self::Decoding(error)
    }
}

/// An image whose header is checked: its pixels may be there.
pub(crate) struct PngImage<'a> {
    reader: png::Reader<Cursor<&'a [u8]>>,
}

impl<'a> PngImage<'a> {
    /// Reads the header.
    pub(crate) fn open(png: &'a [u8], kind: PixelKind) -> Result<Self, PngError> {
        let limits = Limits {
            bytes: MAX_DECODER_BYTES,
        };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(png), limits);
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let header = decoder.read_header_info()?;
        if !kind.allows(header.color_type, header.bit_depth) || header.interlaced {
            return Err(PngError::Kind(kind.rule()));
        }
        if header.width > MAX_SIDE || header.height > MAX_SIDE {
            return Err(PngError::Kind(
                "an image must have at most 8192 pixels a side",
            ));
        }
        let row_bytes = header.raw_row_length() as u64 - 1;
        if row_bytes * u64::from(header.height) > MAX_DEFLATE_EXPANSION * png.len() as u64 {
            return Err(PngError::Kind("the image is too short for its size"));
        }
        let reader = decoder.read_info()?;
        if reader.info().animation_control.is_some() || reader.info().frame_control.is_some() {
            return Err(PngError::Kind("an image must not be animated"));
        }
        Ok(Self { reader })
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> (u32, u32) {
        self.reader.info().size()
    }

    /// Replaces the buffer's content by the values of 16 bits, row by row.
    pub(crate) fn decode_u16(self, values: &mut Vec<u16>) -> Result<(), PngError> {
        let n_pixels = self.n_pixels();
        values.clear();
        values.reserve(n_pixels);
        self.for_each_row(|row| {
            values.extend(row.as_chunks().0.iter().copied().map(u16::from_be_bytes));
        })
    }

    /// Replaces the buffer's content by the values of 8 bits, row by row; a
    /// value of 1 bit becomes 0 or 255.
    pub(crate) fn decode_u8(self, values: &mut Vec<u8>) -> Result<(), PngError> {
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

    /// Row by row, since the decoder would expand whatever follows the last
    /// row if it were asked for the whole image.
    fn for_each_row(mut self, mut visit: impl FnMut(&[u8])) -> Result<(), PngError> {
        let mut row = vec![0; self.reader.info().raw_row_length() - 1];
        for _ in 0..self.size().1 {
            self.reader.read_row(&mut row)?;
            visit(&row);
        }
        Ok(())
    }
}

/// Appends an image to a file, fast rather than small. `samples` are its bytes
/// as PNG stores them, row by row; 16-bit values have their high byte first.
pub(crate) fn encode(
    kind: PixelKind,
    size: (u32, u32),
    samples: &[u8],
    file: &mut Vec<u8>,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(file, size.0, size.1);
    encoder.set_color(kind.color_type());
    encoder.set_depth(kind.bit_depth());
    // As small as level 1 of zlib, in a quarter of the time: `write_frame`.
    encoder.set_deflate_compression(DeflateCompression::FdeflateUltraFast);
    encoder.set_filter(Filter::Paeth);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()
}

/// Replaces the buffer's content by 16-bit values as PNG stores them.
pub(crate) fn to_samples(values: &[u16], samples: &mut Vec<u8>) {
    samples.clear();
    samples.extend(values.iter().flat_map(|value| value.to_be_bytes()));
}
