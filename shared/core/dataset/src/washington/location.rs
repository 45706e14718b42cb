//! Position of a crop in the whole image, in pixels.

use crate::ContentError;
use crate::png_image::MAX_SIDE;

/// Parses a `_loc.txt`: one line `x,y`, column and row counted from 1. Returns the column and
/// row of the crop's first pixel counted from 0.
///
/// # Errors
/// When the text is something else, or a number is not from 1 to 8192.
pub fn parse_location(bytes: &[u8]) -> Result<(u32, u32), ContentError> {
    let number = |text: &str| -> Option<u32> {
        let number = text.trim_ascii().parse().ok()?;
        (1..=MAX_SIDE).contains(&number).then(|| number - 1)
    };
    std::str::from_utf8(bytes)
        .ok()
        .and_then(|text| text.trim_ascii().split_once(','))
        .and_then(|(column, row)| Some((number(column)?, number(row)?)))
        .ok_or(ContentError::Location)
}

/// Formats a `_loc.txt` for a column and row counted from 0.
pub fn format_location((column, row): (u32, u32)) -> String {
    format!("{},{}\n", u64::from(column) + 1, u64::from(row) + 1)
}
