//! Colour image of a cloud at half its size, as PNG.

use super::CAMERA;
use foxglove::bytes::Bytes;
use foxglove::messages::{CompressedImage, Timestamp};
use message::CloudPoint;
use png::{BitDepth, ColorType, Compression, EncodingError};

/// Every n-th row and column is shown. Chosen: a viewer shows 320 x 240 pixels well enough.
const STEP: usize = 2;

/// Image of organised points; `None` when it cannot be encoded.
pub(super) fn compressed(
    points: &[CloudPoint],
    camera: &geometry::PinholeCamera,
    timestamp: Timestamp,
) -> Option<CompressedImage> {
    let png = encoded(points, camera.width as usize).ok()?;
    Some(CompressedImage {
        timestamp: Some(timestamp),
        frame_id: CAMERA.into(),
        data: Bytes::from(png),
        format: "png".into(),
    })
}

fn encoded(points: &[CloudPoint], width: usize) -> Result<Vec<u8>, EncodingError> {
    let mut pixels = Vec::with_capacity(3 * points.len() / (STEP * STEP));
    let mut n_rows = 0;
    for row in points.chunks_exact(width.max(1)).step_by(STEP) {
        n_rows += 1;
        for point in row.iter().step_by(STEP) {
            let [_, red, green, blue] = point.argb.to_be_bytes();
            pixels.extend([red, green, blue]);
        }
    }
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, width.div_ceil(STEP) as u32, n_rows);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(png)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn image_has_half_the_size_in_each_direction() {
        let points = vec![CloudPoint::default(); 7 * 5];
        let png = encoded(&points, 7).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(png))
            .read_info()
            .unwrap();
        assert_eq!(reader.info().size(), (4, 3));
    }
}
