//! The fields of a PCD file.

use super::MAX_BYTES;
use super::error::Error;
use super::header::{Line, Lines};
use crate::number::NumberType;

/// Where the known fields are within a point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) xyz: [Channel; 3],
    pub(super) color: Option<Color>,
    pub(super) label: Option<Channel>,
    /// Bytes of a binary point.
    pub(super) point_bytes: usize,
    /// Values in a point's line of text.
    pub(super) point_values: usize,
}

/// One number of each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Channel {
    pub(super) number: NumberType,
    /// Bytes before it within a binary point.
    pub(super) byte_offset: usize,
    /// Values before it within a line of text.
    pub(super) value_idx: usize,
}

/// A packed colour of each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Color {
    pub(super) channel: Channel,
    /// Whether the highest byte is an alpha value.
    pub(super) has_alpha: bool,
}

impl Layout {
    pub(super) fn parse(lines: &Lines<'_>) -> Result<Self, Error> {
        let names = lines.require("FIELDS")?;
        let (sizes, types) = (lines.require("SIZE")?, lines.require("TYPE")?);
        let counts = lines.find("COUNT");
        for line in [Some(sizes), Some(types), counts].into_iter().flatten() {
            if line.words.len() != names.words.len() {
                return Err(line.error("it does not have one entry for each of FIELDS"));
            }
        }
        let mut fields = Fields::default();
        for (idx, name) in names.words.iter().enumerate() {
            let count = counts.map_or(Ok(1), |line| line.number(idx))?;
            let number = number_type(sizes, types, idx)?;
            fields
                .push(name, number, count)
                .ok_or_else(|| names.error("a field is too large"))?;
        }
        fields.finish()
    }
}

/// The known fields met so far, and the size of all.
#[derive(Default)]
struct Fields<'a> {
    known: Vec<(&'a str, Channel, usize)>,
    point_bytes: usize,
    point_values: usize,
}

impl<'a> Fields<'a> {
    /// `None` when a point becomes larger than any file.
    fn push(&mut self, name: &'a str, number: NumberType, count: usize) -> Option<()> {
        let (byte_offset, value_idx) = (self.point_bytes, self.point_values);
        self.point_bytes = number.size().checked_mul(count)?.checked_add(byte_offset)?;
        self.point_values = count.checked_add(value_idx)?;
        if matches!(name, "x" | "y" | "z" | "rgb" | "rgba" | "label") {
            self.known.push((
                name,
                Channel {
                    number,
                    byte_offset,
                    value_idx,
                },
                count,
            ));
        }
        (self.point_bytes as u64 <= MAX_BYTES).then_some(())
    }

    fn find(&self, name: &str) -> Result<Option<Channel>, Error> {
        let mut found = self.known.iter().filter(|(known, ..)| *known == name);
        match (found.next(), found.next()) {
            (None, _) => Ok(None),
            (Some((_, channel, 1)), None) => Ok(Some(*channel)),
            _ => Err(Error::Fields(
                "x, y, z, rgb, rgba and label must be there once, with COUNT 1",
            )),
        }
    }

    fn coordinate(&self, name: &str) -> Result<Channel, Error> {
        match self.find(name)? {
            Some(channel) if !channel.number.is_integer() => Ok(channel),
            _ => Err(Error::Fields(
                "x, y and z must be there, with TYPE F and SIZE 4 or 8",
            )),
        }
    }

    fn finish(self) -> Result<Layout, Error> {
        let rgba = self.find("rgba")?.map(|channel| Color {
            channel,
            has_alpha: true,
        });
        let rgb = self.find("rgb")?.map(|channel| Color {
            channel,
            has_alpha: false,
        });
        let color = rgba.or(rgb);
        if color.is_some_and(|color| color.channel.number.size() != 4) {
            return Err(Error::Fields("rgb and rgba must have SIZE 4"));
        }
        Ok(Layout {
            xyz: [
                self.coordinate("x")?,
                self.coordinate("y")?,
                self.coordinate("z")?,
            ],
            color,
            label: self.find("label")?,
            point_bytes: self.point_bytes,
            point_values: self.point_values,
        })
    }
}

fn number_type(sizes: &Line<'_>, types: &Line<'_>, idx: usize) -> Result<NumberType, Error> {
    match (types.words[idx], sizes.words[idx]) {
        ("I", "1") => Ok(NumberType::I8),
        ("I", "2") => Ok(NumberType::I16),
        ("I", "4") => Ok(NumberType::I32),
        ("I", "8") => Ok(NumberType::I64),
        ("U", "1") => Ok(NumberType::U8),
        ("U", "2") => Ok(NumberType::U16),
        ("U", "4") => Ok(NumberType::U32),
        ("U", "8") => Ok(NumberType::U64),
        ("F", "4") => Ok(NumberType::F32),
        ("F", "8") => Ok(NumberType::F64),
        _ => Err(types.error("a field is not I or U of SIZE 1, 2, 4 or 8, or F of 4 or 8")),
    }
}
