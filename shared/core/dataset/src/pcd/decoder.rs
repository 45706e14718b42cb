//! Filling a slice with the points of a PCD file.

use super::error::Error;
use super::header::{Encoding, Header};
use super::layout::{Channel, Color, Layout};
use super::text;
use crate::NEUTRAL_GREY;
use crate::lzf;
use crate::number::{ByteOrder, NumberType, as_u32, read_bits};
use point_cloud::{Point, Rgba};

/// Decodes PCD files one after the other and keeps its memory in between.
#[derive(Debug, Default)]
pub struct Decoder {
    expanded: Vec<u8>,
}

impl Decoder {
    /// A decoder without memory yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Fills `points`, and `labels` when they are wanted, from the bytes of the
    /// file that `header` was parsed from.
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
        let planes = match header.encoding {
            Encoding::Ascii => return text::decode(data, &header.layout, points, labels),
            Encoding::Binary => Planes::interleaved(data, header)?,
            Encoding::BinaryCompressed => self.expand(data, header)?,
        };
        planes.fill_points(&header.layout, points);
        if let (Some(labels), Some(label)) = (labels, label) {
            planes.fill_labels(label, labels)?;
        }
        Ok(())
    }

    fn expand(&mut self, data: &[u8], header: &Header) -> Result<Planes<'_>, Error> {
        let n_bytes = header.n_binary_bytes();
        lzf::decompress(header.compressed(data)?, n_bytes, &mut self.expanded)
            .map_err(Error::Compression)?;
        Ok(Planes {
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

/// The points' bytes, and how the values of one channel are spaced in them.
struct Planes<'a> {
    data: &'a [u8],
    spacing: Spacing,
}

#[derive(Clone, Copy)]
enum Spacing {
    /// Point after point, of so many bytes.
    Interleaved(usize),
    /// Field after field, for so many points.
    Planar(usize),
}

impl<'a> Planes<'a> {
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
        let [x, y, z] = layout.xyz.map(|channel| self.floats(channel));
        let color = layout.color.and_then(|color| self.words(color.channel));
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
                    *point = measured(x, y, z, Rgba(u32::from_le_bytes(*color) | opaque));
                }
            }
            _ => self.fill_any_points(layout, points),
        }
    }

    fn fill_any_points(&self, layout: &Layout, points: &mut [Point]) {
        for (point_idx, point) in points.iter_mut().enumerate() {
            let [x, y, z] = layout
                .xyz
                .map(|channel| self.number(channel, point_idx) as f32);
            let color = match layout.color {
                Some(color) => packed(color, self.bits(color.channel, point_idx) as u32),
                None => NEUTRAL_GREY,
            };
            *point = measured(x, y, z, color);
        }
    }

    fn fill_labels(&self, channel: Channel, labels: &mut [u32]) -> Result<(), Error> {
        for (point_idx, label) in labels.iter_mut().enumerate() {
            let value = self.number(channel, point_idx);
            *label = as_u32(value).ok_or(Error::Label { point_idx, value })?;
        }
        Ok(())
    }

    /// All values of a planar channel of single-precision floats.
    fn floats(&self, channel: Channel) -> Option<&'a [[u8; 4]]> {
        (channel.number == NumberType::F32)
            .then(|| self.words(channel))
            .flatten()
    }

    /// All values of a planar channel of four bytes.
    fn words(&self, channel: Channel) -> Option<&'a [[u8; 4]]> {
        let Spacing::Planar(n_points) = self.spacing else {
            return None;
        };
        let start = channel.byte_offset * n_points;
        Some(self.data.get(start..start + 4 * n_points)?.as_chunks().0)
    }

    #[inline]
    fn number(&self, channel: Channel, point_idx: usize) -> f64 {
        let start = self.start(channel, point_idx);
        // A layout never reaches beyond its points.
        channel
            .number
            .read(&self.data[start..], ByteOrder::Little)
            .unwrap_or(f64::NAN)
    }

    #[inline]
    fn bits(&self, channel: Channel, point_idx: usize) -> u64 {
        let (start, size) = (self.start(channel, point_idx), channel.number.size());
        read_bits(&self.data[start..], size, ByteOrder::Little).unwrap_or(0)
    }

    #[inline]
    fn start(&self, channel: Channel, point_idx: usize) -> usize {
        match self.spacing {
            Spacing::Interleaved(point_bytes) => point_idx * point_bytes + channel.byte_offset,
            Spacing::Planar(n_points) => {
                n_points * channel.byte_offset + point_idx * channel.number.size()
            }
        }
    }
}

const OPAQUE: u32 = 0xff00_0000;

/// A colour from its bits as stored.
#[inline]
pub(super) fn packed(color: Color, bits: u32) -> Rgba {
    Rgba(if color.has_alpha { bits } else { bits | OPAQUE })
}

/// A point, all of whose coordinates are finite or none.
#[inline]
pub(super) fn measured(x: f32, y: f32, z: f32, color: Rgba) -> Point {
    let point = Point { x, y, z, color };
    if point.is_finite() {
        point
    } else {
        Point::without_depth(color)
    }
}
