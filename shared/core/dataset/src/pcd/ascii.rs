//! Decoder of the points of an ASCII PCD file.

use super::error::Error;
use super::layout::{ColorField, Field, Layout};
use super::point_value::{finite_or_nan, unpack_color};
use crate::NEUTRAL_GREY;
use file_access::{NumberType, as_u32, excerpt};
use point_cloud::{Point, Rgba};

/// Decodes one line of text for each point into the slices; blank lines are skipped.
pub(super) fn decode(
    data: &[u8],
    layout: &Layout,
    points: &mut [Point],
    mut labels: Option<&mut [u32]>,
) -> Result<(), Error> {
    let (mut n_read, mut n_lines) = (0, 0);
    let mut words = Vec::new();
    for bytes in data.split(|&byte| byte == b'\n') {
        n_lines += 1;
        let error = |problem| Error::PointLine {
            line: n_lines,
            problem,
        };
        let text = std::str::from_utf8(bytes).map_err(|_| error("it is not text".to_owned()))?;
        words.clear();
        words.extend(text.split_ascii_whitespace().take(layout.point_values + 1));
        if words.is_empty() {
            continue;
        }
        let Some(target) = points.get_mut(n_read) else {
            return Err(error(
                "there are more points than the header announces".to_owned(),
            ));
        };
        *target = point(&words, layout).map_err(error)?;
        if let (Some(labels), Some(field)) = (labels.as_deref_mut(), layout.label) {
            let value = number(&words, field).map_err(error)?;
            labels[n_read] = as_u32(value).ok_or(Error::Label {
                point_idx: n_read,
                value,
            })?;
        }
        n_read += 1;
    }
    if n_read < points.len() {
        let problem = format!("the data ends after {n_read} of {} points", points.len());
        return Err(Error::PointLine {
            line: n_lines,
            problem,
        });
    }
    Ok(())
}

fn point(words: &[&str], layout: &Layout) -> Result<Point, String> {
    if words.len() != layout.point_values {
        return Err(format!("it does not have {} values", layout.point_values));
    }
    let [x, y, z] = layout.xyz.map(|field| number(words, field));
    let color = layout
        .color
        .map_or(Ok(NEUTRAL_GREY), |field| color(words, field))?;
    Ok(finite_or_nan(x? as f32, y? as f32, z? as f32, color))
}

fn number(words: &[&str], field: Field) -> Result<f64, String> {
    let word = words[field.value_idx];
    field.number.parse(word).ok_or_else(|| {
        format!(
            "\"{}\" is not a number of the announced type",
            excerpt(word)
        )
    })
}

/// Parses a packed colour, written as an integer or as the float with the same bits. Many bit
/// patterns are written as the same "nan"; such a colour is lost.
fn color(words: &[&str], color: ColorField) -> Result<Rgba, String> {
    let value = number(words, color.field)?;
    let bits = match color.field.number {
        NumberType::F32 if value.is_nan() => return Ok(NEUTRAL_GREY),
        NumberType::F32 => (value as f32).to_bits(),
        _ => value as i64 as u32,
    };
    Ok(unpack_color(color, bits))
}
