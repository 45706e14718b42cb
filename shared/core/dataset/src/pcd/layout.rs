//! Field layout of a PCD file.

use super::MAX_BYTES;
use super::error::Error;
use super::header_lines::{Line, Lines};
use file_access::NumberType;

/// Positions of the known fields within a point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) xyz: [Field; 3],
    pub(super) color: Option<ColorField>,
    pub(super) label: Option<Field>,
    /// Size of one binary point, bytes.
    pub(super) point_bytes: usize,
    /// Number of values in a line of text.
    pub(super) point_values: usize,
}

/// Field with one number for each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Field {
    pub(super) number: NumberType,
    /// Offset of the field within a binary point, bytes.
    pub(super) byte_offset: usize,
    /// Number of preceding values within a line of text.
    pub(super) value_idx: usize,
}

/// Field with a packed colour for each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ColorField {
    pub(super) field: Field,
    /// True if the highest byte is an alpha value.
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
        let mut fields = FieldList::default();
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

/// Known fields parsed so far, and the size of all fields.
#[derive(Default)]
struct FieldList<'a> {
    known: Vec<(&'a str, Field, usize)>,
    point_bytes: usize,
    point_values: usize,
}

impl<'a> FieldList<'a> {
    /// Appends a field; `None` when a point would exceed the file size limit.
    fn push(&mut self, name: &'a str, number: NumberType, count: usize) -> Option<()> {
        let (byte_offset, value_idx) = (self.point_bytes, self.point_values);
        self.point_bytes = number.size().checked_mul(count)?.checked_add(byte_offset)?;
        self.point_values = count.checked_add(value_idx)?;
        if matches!(name, "x" | "y" | "z" | "rgb" | "rgba" | "label") {
            self.known.push((
                name,
                Field {
                    number,
                    byte_offset,
                    value_idx,
                },
                count,
            ));
        }
        (self.point_bytes as u64 <= MAX_BYTES).then_some(())
    }

    fn find(&self, name: &str) -> Result<Option<Field>, Error> {
        let mut found = self.known.iter().filter(|(known, ..)| *known == name);
        match (found.next(), found.next()) {
            (None, _) => Ok(None),
            (Some((_, field, 1)), None) => Ok(Some(*field)),
            _ => Err(Error::Fields(
                "x, y, z, rgb, rgba and label must be there once, with COUNT 1",
            )),
        }
    }

    fn coordinate(&self, name: &str) -> Result<Field, Error> {
        match self.find(name)? {
            Some(field) if !field.number.is_integer() => Ok(field),
            _ => Err(Error::Fields(
                "x, y and z must be there, with TYPE F and SIZE 4 or 8",
            )),
        }
    }

    fn finish(self) -> Result<Layout, Error> {
        let rgba = self.find("rgba")?.map(|field| ColorField {
            field,
            has_alpha: true,
        });
        let rgb = self.find("rgb")?.map(|field| ColorField {
            field,
            has_alpha: false,
        });
        let color = rgba.or(rgb);
        if color.is_some_and(|color| color.field.number.size() != 4) {
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
