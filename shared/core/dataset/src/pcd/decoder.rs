//! Decoder of the points of a PCD file into slices.

use super::ascii;
use super::encoding::Encoding;
use super::error::Error;
use super::header::Header;
use super::layout::{Field, Layout};
use super::point_value::{OPAQUE, finite_or_nan, unpack_color};
use crate::NEUTRAL_GREY;
use crate::lzf;
use file_access::{ByteOrder, NumberType, as_u32, read_bits};
use point_cloud::{Point, Rgba};

/// Decoder of PCD files that reuses its memory from file to file.
#[derive(Debug, Default)]
pub struct Decoder {
    expanded: Vec<u8>,
}

impl Decoder {
    /// Creates a decoder without allocated buffers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Decodes points, and labels if requested, from the bytes of the file that `header` was parsed
    /// from.
    ///
    /// *Shape*: both have [`Header::n_points`] elements, row by row. After an
    /// error their content is unspecified.
    /// *Allocation*: none once the largest compressed file has been seen.
    /// *Speed*: benchmark `pcd_binary_compressed`.
    ///
    /// # Errors
    /// When a slice has the wrong length, labels are wanted and not there, or
    /// the data is damaged.
    pub fn decode_into(
        &mut self,
        bytes: &[u8],
        header: &Header,
        points: &mut [Point],
        labels: Option<&mut [u32]>,
    ) -> Result<(), Error> {
        check_length("points", points.len(), header.n_points())?;
        if let Some(labels) = &labels {
            check_length("labels", labels.len(), header.n_points())?;
        }
        let label = match (&labels, header.layout.label) {
            (Some(_), None) => return Err(Error::NoLabels),
            (_, label) => label,
        };
        let data = bytes.get(header.data_offset..).unwrap_or_default();
        let data = match header.encoding {
            Encoding::Ascii => return ascii::decode(data, &header.layout, points, labels),
            Encoding::Binary => PointData::interleaved(data, header)?,
            Encoding::BinaryCompressed => self.expand(data, header)?,
        };
        data.fill_points(&header.layout, points);
        if let (Some(labels), Some(label)) = (labels, label) {
            data.fill_labels(label, labels)?;
        }
        Ok(())
    }

    fn expand(&mut self, data: &[u8], header: &Header) -> Result<PointData<'_>, Error> {
        let n_bytes = header.n_binary_bytes();
        lzf::decompress(header.compressed(data)?, n_bytes, &mut self.expanded)
            .map_err(Error::Compression)?;
        Ok(PointData {
            data: &self.expanded[..n_bytes],
            spacing: Spacing::Planar(header.n_points()),
        })
    }
}

fn check_length(what: &'static str, given: usize, needed: usize) -> Result<(), Error> {
    if given == needed {
        Ok(())
    } else {
        Err(Error::SizeMismatch {
            what,
            given,
            needed,
        })
    }
}

/// Binary point data, interleaved or planar.
struct PointData<'a> {
    data: &'a [u8],
    spacing: Spacing,
}

#[derive(Clone, Copy)]
enum Spacing {
    /// Point after point; size of a point, bytes.
    Interleaved(usize),
    /// Planar: all values of one field, then the next; the number of points.
    Planar(usize),
}

impl<'a> PointData<'a> {
    fn interleaved(data: &'a [u8], header: &Header) -> Result<Self, Error> {
        let (needed, present) = (header.n_binary_bytes(), data.len());
        let data = data
            .get(..needed)
            .ok_or(Error::Truncated { needed, present })?;
        Ok(Self {
            data,
            spacing: Spacing::Interleaved(header.layout.point_bytes),
        })
    }

    fn fill_points(&self, layout: &Layout, points: &mut [Point]) {
        let [x, y, z] = layout.xyz.map(|field| self.floats(field));
        let color = layout.color.and_then(|color| self.words(color.field));
        let opaque = if layout.color.is_some_and(|color| color.has_alpha) {
            0
        } else {
            OPAQUE
        };
        match (x, y, z, color) {
            (Some(x), Some(y), Some(z), Some(color)) => {
                let values = x.iter().zip(y).zip(z).zip(color);
                for (point, (((x, y), z), color)) in points.iter_mut().zip(values) {
                    let [x, y, z] = [*x, *y, *z].map(f32::from_le_bytes);
                    *point = finite_or_nan(x, y, z, Rgba(u32::from_le_bytes(*color) | opaque));
                }
            }
            _ => self.fill_any_points(layout, points),
        }
    }

    fn fill_any_points(&self, layout: &Layout, points: &mut [Point]) {
        for (point_idx, point) in points.iter_mut().enumerate() {
            let [x, y, z] = layout.xyz.map(|field| self.number(field, point_idx) as f32);
            let color = match layout.color {
                Some(color) => unpack_color(color, self.bits(color.field, point_idx) as u32),
                None => NEUTRAL_GREY,
            };
            *point = finite_or_nan(x, y, z, color);
        }
    }

    fn fill_labels(&self, field: Field, labels: &mut [u32]) -> Result<(), Error> {
        for (point_idx, label) in labels.iter_mut().enumerate() {
            let value = self.number(field, point_idx);
            *label = as_u32(value).ok_or(Error::Label { point_idx, value })?;
        }
        Ok(())
    }

    /// Values of a planar field of single-precision floats.
    fn floats(&self, field: Field) -> Option<&'a [[u8; 4]]> {
        (field.number == NumberType::F32)
            .then(|| self.words(field))
            .flatten()
    }

    /// Values of a planar field of four bytes.
    fn words(&self, field: Field) -> Option<&'a [[u8; 4]]> {
        let Spacing::Planar(n_points) = self.spacing else {
            return None;
        };
        let start = field.byte_offset * n_points;
        Some(self.data.get(start..start + 4 * n_points)?.as_chunks().0)
    }

    #[inline]
    fn number(&self, field: Field, point_idx: usize) -> f64 {
        let start = self.start(field, point_idx);
        // A layout never reaches beyond its points.
        field
            .number
            .read(&self.data[start..], ByteOrder::Little)
            .unwrap_or(f64::NAN)
    }

    #[inline]
    fn bits(&self, field: Field, point_idx: usize) -> u64 {
        let (start, size) = (self.start(field, point_idx), field.number.size());
        read_bits(&self.data[start..], size, ByteOrder::Little).unwrap_or(0)
    }

    #[inline]
    fn start(&self, field: Field, point_idx: usize) -> usize {
        match self.spacing {
            Spacing::Interleaved(point_bytes) => point_idx * point_bytes + field.byte_offset,
            Spacing::Planar(n_points) => {
                n_points * field.byte_offset + point_idx * field.number.size()
            }
        }
    }
}
