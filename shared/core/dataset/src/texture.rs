//! Texture image with a pyramid of coarser images (mip-mapping).

use crate::png_image::{MAX_SIDE, SIGNATURE};
use crate::{ImageError, jpeg_image};
use png::{BitDepth, ColorType, Limits, Transformations};
use std::io::Cursor;

/// Maximum number of columns or rows of a texture in memory, pixels; larger images are reduced.
/// The texture of a mesh of 20 000 triangles has about 10 000 samples. Chosen.
const KEPT_SIDE: u32 = 1024;

/// Memory limit of the PNG decoder itself, bytes.
const MAX_DECODER_BYTES: usize = 1 << 24;

/// Maximum expansion factor of deflated PNG data.
const MAX_DEFLATE_EXPANSION: u64 = 1032;

/// Texture image, repeated in both directions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Texture {
    /// Images of halved size, the finest first; at least one.
    levels: Vec<Level>,
}

/// Image of a pyramid, row-major, at least one pixel.
#[derive(Debug, Clone, PartialEq)]
struct Level {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Texture {
    /// Decodes a PNG or JPEG image, known by its signature. Transparency is ignored.
    ///
    /// # Errors
    /// When the image is of another format, damaged, larger than 8192 pixels a side, interlaced,
    /// or not in red, green and blue or grey.
    pub(crate) fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        let finest = if bytes.starts_with(&SIGNATURE) {
            decode_png(bytes)?
        } else if bytes.starts_with(&[0xff, 0xd8]) {
            decode_jpeg(bytes)?
        } else {
            return Err(ImageError::Format("it is neither PNG nor JPEG"));
        };
        let mut levels = vec![finest];
        while let Some(coarser) = levels.last().and_then(Level::halved) {
            levels.push(coarser);
        }
        Ok(Self { levels })
    }

    /// Width and height of the finest level, pixels.
    pub(crate) fn size(&self) -> [f32; 2] {
        let finest = &self.levels[0];
        [finest.width as f32, finest.height() as f32]
    }

    /// Colour at texture coordinates, `v` upwards, averaged over about `footprint` pixels of the
    /// finest level. Any coordinates are accepted.
    pub(crate) fn sample(&self, [u, v]: [f32; 2], footprint: f32) -> [u8; 3] {
        let wanted = footprint.max(1.0).log2() as usize;
        let level = &self.levels[wanted.min(self.levels.len() - 1)];
        let repeated = |x: f32| x - x.floor();
        let x = repeated(u) * level.width as f32 - 0.5;
        let y = repeated(-v) * level.height() as f32 - 0.5;
        let (column, row) = (x.floor(), y.floor());
        let pixel = |dx: f32, dy: f32| level.pixel((column + dx) as i64, (row + dy) as i64);
        let (right, down) = (x - column, y - row);
        let mix = |a: u8, b: u8, share: f32| f32::from(a) + share * (f32::from(b) - f32::from(a));
        let [a, b, c, d] = [
            pixel(0.0, 0.0),
            pixel(1.0, 0.0),
            pixel(0.0, 1.0),
            pixel(1.0, 1.0),
        ];
        [0, 1, 2].map(|k| {
            let (above, below) = (mix(a[k], b[k], right), mix(c[k], d[k], right));
            (above + down * (below - above)).round() as u8
        })
    }
}

impl Level {
    fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// Pixel with wrapped coordinates.
    fn pixel(&self, column: i64, row: i64) -> [u8; 3] {
        let column = column.rem_euclid(self.width as i64) as usize;
        let row = row.rem_euclid(self.height() as i64) as usize;
        self.pixels[row * self.width + column]
    }

    /// Image of half the size; `None` for a single pixel.
    fn halved(&self) -> Option<Self> {
        if self.pixels.len() == 1 {
            return None;
        }
        let mut reducer = Reducer::new((self.width as u32, self.height() as u32), 2);
        for row in self.pixels.chunks(self.width) {
            reducer.push_row(row.iter().copied());
        }
        Some(reducer.finish())
    }
}

/// Reduction of an image by an integral factor, row by row: means of square blocks. A block at the
/// right and lower rim may be smaller.
struct Reducer {
    factor: usize,
    level: Level,
    /// Sum of the colours of each block of the present row of blocks, and its number of pixels.
    blocks: Vec<([u32; 3], u32)>,
    n_rows: usize,
}

impl Reducer {
    fn new((width, height): (u32, u32), factor: u32) -> Self {
        let reduced = |side: u32| side.div_ceil(factor) as usize;
        let width = reduced(width).max(1);
        Self {
            factor: factor as usize,
            level: Level {
                width,
                pixels: Vec::with_capacity(width * reduced(height)),
            },
            blocks: vec![([0; 3], 0); width],
            n_rows: 0,
        }
    }

    fn push_row(&mut self, row: impl Iterator<Item = [u8; 3]>) {
        for (column, pixel) in row.enumerate() {
            if let Some((sum, n)) = self.blocks.get_mut(column / self.factor) {
                for (sum, value) in sum.iter_mut().zip(pixel) {
                    *sum += u32::from(value);
                }
                *n += 1;
            }
        }
        self.n_rows += 1;
        if self.n_rows == self.factor {
            self.end_blocks();
        }
    }

    fn end_blocks(&mut self) {
        self.n_rows = 0;
        for (sum, n) in &mut self.blocks {
            let n_pixels = (*n).max(1);
            let mean = sum.map(|sum| ((sum + n_pixels / 2) / n_pixels) as u8);
            self.level.pixels.push(mean);
            (*sum, *n) = ([0; 3], 0);
        }
    }

    fn finish(mut self) -> Level {
        if self.n_rows > 0 {
            self.end_blocks();
        }
        self.level
    }
}

/// Factor by which an image of this size is reduced.
fn reduction((width, height): (u32, u32)) -> u32 {
    width.max(height).div_ceil(KEPT_SIDE).max(1)
}

fn check_sides((width, height): (u32, u32)) -> Result<(), ImageError> {
    if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
        Ok(())
    } else {
        Err(ImageError::Format(
            "a texture must have 1 to 8192 pixels a side",
        ))
    }
}

fn decode_png(bytes: &[u8]) -> Result<Level, ImageError> {
    let limits = Limits {
        bytes: MAX_DECODER_BYTES,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let header = decoder.read_header_info()?;
    let size = (header.width, header.height);
    check_sides(size)?;
    if header.interlaced {
        return Err(ImageError::Format("a texture must not be interlaced"));
    }
    let row_bytes = header.raw_row_length() as u64 - 1;
    if row_bytes * u64::from(size.1) > MAX_DEFLATE_EXPANSION * bytes.len() as u64 {
        return Err(ImageError::Format("the image is too short for its size"));
    }
    let mut reader = decoder.read_info()?;
    let (color_type, bit_depth) = reader.output_color_type();
    let (n_channels, Some(row_bytes)) = (color_type.samples(), reader.output_line_size(size.0))
    else {
        return Err(ImageError::Format("a texture must be smaller"));
    };
    if bit_depth != BitDepth::Eight || color_type == ColorType::Indexed {
        return Err(ImageError::Format("a texture must have 8 bits a channel"));
    }
    let mut row = vec![0; row_bytes];
    let mut reducer = Reducer::new(size, reduction(size));
    for _ in 0..size.1 {
        // For a whole image the decoder would also expand any data after the last row.
        reader.read_row(&mut row)?;
        reducer.push_row(row.chunks_exact(n_channels).map(|pixel| match *pixel {
            [red, green, blue] | [red, green, blue, _] => [red, green, blue],
            [grey, ..] => [grey; 3],
            [] => [0; 3],
        }));
    }
    Ok(reducer.finish())
}

fn decode_jpeg(bytes: &[u8]) -> Result<Level, ImageError> {
    let (header, pixels) = jpeg_image::decode(bytes, |header| {
        check_sides(header.size)?;
        if matches!(header.n_channels, 1 | 3) {
            Ok(())
        } else {
            Err(ImageError::Format(
                "a JPEG texture must be in red, green and blue or grey",
            ))
        }
    })?;
    let mut reducer = Reducer::new(header.size, reduction(header.size));
    for row in pixels.chunks_exact(3 * header.size.0 as usize) {
        reducer.push_row(row.as_chunks().0.iter().copied());
    }
    let level = reducer.finish();
    if level.pixels.is_empty() {
        return Err(ImageError::Format("the image is too short for its size"));
    }
    Ok(level)
}

/// PNG image for tests.
#[cfg(test)]
pub(crate) fn test_png(width: u32, color_type: ColorType, samples: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let height = samples.len() / color_type.samples() / width as usize;
    let mut encoder = png::Encoder::new(&mut file, width, height as u32);
    encoder.set_color(color_type);
    if color_type == ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 0, 0, 0, 0, 255]);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(samples).unwrap();
    drop(writer);
    file
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd_sequence::test_flat_jpeg;
    use mutation_fuzzing::{assert_sentence, flipped_bits, fuzz, truncations};

    #[test]
    fn textures_of_all_pixel_formats_have_their_colours() {
        let red_blue = [255, 0, 0, 0, 0, 255];
        let with_alpha = [255, 0, 0, 9, 0, 0, 255, 0];
        for (color_type, samples) in [
            (ColorType::Rgb, &red_blue[..]),
            (ColorType::Rgba, &with_alpha[..]),
            (ColorType::Indexed, &[1, 2]),
        ] {
            let texture = Texture::decode(&test_png(2, color_type, samples)).unwrap();
            assert_eq!(texture.sample([0.25, 0.5], 1.0), [255, 0, 0]);
            assert_eq!(texture.sample([-1.25, 7.0], 1.0), [0, 0, 255], "repeated");
            assert_eq!(texture.sample([0.5, 0.5], 1.0), [128, 0, 128]);
            assert_eq!(
                texture.sample([0.25, 0.5], 100.0),
                [128, 0, 128],
                "averaged"
            );
            texture.sample([f32::NAN, f32::MAX], f32::NAN);
        }
        for (color_type, samples) in [
            (ColorType::Grayscale, &[7, 9][..]),
            (ColorType::GrayscaleAlpha, &[7, 1, 9, 1]),
        ] {
            let texture = Texture::decode(&test_png(2, color_type, samples)).unwrap();
            assert_eq!(texture.sample([0.75, 0.5], 1.0), [9; 3]);
        }
        let jpeg = test_flat_jpeg::encode(2, 1, &[[76, 85, 255], [100, 128, 128]]);
        let texture = Texture::decode(&jpeg).unwrap();
        assert_eq!(texture.size(), [16.0, 8.0]);
        assert!(texture.sample([0.25, 0.5], 1.0)[0] > 250);
    }

    #[test]
    fn textures_begin_at_the_lower_left_corner() {
        let rows = [10, 20, 30, 40];
        let texture = Texture::decode(&test_png(2, ColorType::Grayscale, &rows)).unwrap();
        for (uv, grey) in [([0.25, 0.25], 30), ([0.25, 0.75], 10), ([0.75, 0.75], 20)] {
            assert_eq!(texture.sample(uv, 1.0), [grey; 3], "{uv:?}");
        }
    }

    #[test]
    fn textures_of_large_images_are_reduced() {
        let samples: Vec<u8> = (0..3000 * 2)
            .map(|i| if i % 3000 < 1500 { 0 } else { 200 })
            .collect();
        let texture = Texture::decode(&test_png(3000, ColorType::Grayscale, &samples)).unwrap();
        assert_eq!(texture.size(), [1000.0, 1.0]);
        assert_eq!(texture.sample([0.3, 0.0], 1.0), [0; 3]);
        assert_eq!(texture.sample([0.7, 0.0], 64.0), [200; 3]);
    }

    #[test]
    fn fuzz_textures() {
        let png = test_png(4, ColorType::Indexed, &[1, 2, 0, 1, 2, 2, 1, 1]);
        let jpeg = test_flat_jpeg::encode(2, 1, &[[76, 85, 255], [100, 128, 128]]);
        let check = |bytes: &[u8]| match Texture::decode(bytes) {
            Ok(texture) => {
                texture.sample([0.3, 0.4], 2.0);
            }
            Err(error) => assert_sentence(&error),
        };
        for file in truncations(&png)
            .chain(flipped_bits(&png))
            .chain(truncations(&jpeg))
        {
            check(&file);
        }
        fuzz(&[png, jpeg, b"BM".to_vec()], check);
    }
}
