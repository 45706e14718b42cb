//! Decoding and encoding errors of the PNG and JPEG images of a dataset.

use thiserror::Error;

/// Decoding or encoding error of an image: damaged data, another pixel format, another size.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// Damaged PNG data.
    #[error("the PNG image is damaged: {0}")]
    Png(#[from] png::DecodingError),
    /// Error of the PNG encoder.
    #[error("the PNG image cannot be made: {0}")]
    Encoding(#[from] png::EncodingError),
    /// Damaged JPEG data.
    #[error("the JPEG image is damaged: {}", one_line(.0))]
    Jpeg(#[from] zune_jpeg::errors::DecodeErrors),
    /// Pixel format or structure other than required; the broken rule as a sentence.
    #[error("{0}")]
    Format(&'static str),
    /// Image size other than that of the reference image.
    #[error(
        "the image has {}x{} pixels, and {reference} {}x{}",
        .found.0, .found.1, .needed.0, .needed.1
    )]
    Size {
        /// Width and height found in the image, pixels.
        found: (u32, u32),
        /// Columns and rows of the reference image.
        needed: (u32, u32),
        /// Reference image, as named in the sentence.
        reference: &'static str,
    },
}

/// Message of an error on one line; some messages of the JPEG decoder contain line breaks.
fn one_line(error: &dyn std::error::Error) -> String {
    let text = error.to_string();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
