//! PNG files of pictures.

use png::{BitDepth, ColorType, EncodingError};
use service::Failure;
use std::path::Path;

/// Writes an image of three bytes a pixel; an existing file is replaced when the new one is
/// complete.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write(path: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| {
        Failure::general(format!(
            "the picture {} could not be written: {error}",
            path.display()
        ))
    };
    let png = encoded(width, height, rgb).map_err(|error| failed(&error))?;
    dataset::write_atomic(path, &png).map_err(|error| failed(&error))
}

fn encoded(width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, width as u32, height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(png)
}
