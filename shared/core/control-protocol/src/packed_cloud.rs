//! Packed point cloud of a key view: quantised coordinates and colours as bytes.
//!
//! All numbers are little-endian:
//!
//! | bytes | type | what |
//! |---|---|---|
//! | 0 to 3 | `u32` | number of the format, 1 |
//! | 4 to 7 | `u32` | number of points |
//! | 8 to 19 | `f32` × 3 | x, y, z of the origin, metres |
//! | 9 for each point | `i16` × 3 | x, y, z from the origin, tenths of a millimetre |
//! | | `u8` × 3 | red, green, blue |
//!
//! *Frame*: that of the view's box.

use geometry::RigidTransform;
use nalgebra::Point3;
use point_cloud::{Point, Rgba};
use std::borrow::Borrow;

/// Maximum number of points of a packed cloud, so that a view fits into one request.
pub const MAX_CLOUD_POINTS: usize = 30_000;

const FORMAT: u32 = 1;
const HEADER_BYTES: usize = 20;
const POINT_BYTES: usize = 9;
/// Resolution of the packed coordinates, metres.
const RESOLUTION_M: f64 = 1e-4;

/// Packs points after transforming them by `frame_from_points` into the frame of the view's
/// box. Returns no bytes when no point is left.
///
/// The quantisation error is at most 0.05 mm plus the rounding of the origin. More than
/// [`MAX_CLOUD_POINTS`] points are subsampled evenly. Points without depth are dropped, and
/// those more than 3.27 m from the centre along an axis.
pub fn pack_cloud(
    points: impl Iterator<Item = impl Borrow<Point>>,
    frame_from_points: &RigidTransform,
) -> Vec<u8> {
    let mut transformed: Vec<(Point3<f64>, Rgba)> = points
        .map(|point| *point.borrow())
        .filter(Point::is_finite)
        .map(|point| (frame_from_points * point.position(), point.color))
        .collect();
    subsample_evenly(&mut transformed);
    let origin = bounding_box_centre(&transformed);
    let mut bytes = Vec::with_capacity(HEADER_BYTES + transformed.len() * POINT_BYTES);
    bytes.resize(HEADER_BYTES, 0);
    bytes.extend(
        transformed
            .iter()
            .filter_map(|(place, color)| quantized_point(place, *color, &origin))
            .flatten(),
    );
    let n_points = (bytes.len() - HEADER_BYTES) / POINT_BYTES;
    if n_points == 0 {
        return Vec::new();
    }
    let [x, y, z] = origin.map(f32::to_le_bytes);
    let count = (n_points as u32).to_le_bytes();
    let header = [FORMAT.to_le_bytes(), count, x, y, z];
    bytes[..HEADER_BYTES].copy_from_slice(header.as_flattened());
    bytes
}

/// Subsamples evenly to at most [`MAX_CLOUD_POINTS`].
fn subsample_evenly<T>(points: &mut Vec<T>) {
    let n_points = points.len();
    let share = |n: usize| n * MAX_CLOUD_POINTS / n_points;
    let mut index = 0;
    points.retain(|_| {
        index += 1;
        n_points <= MAX_CLOUD_POINTS || share(index) > share(index - 1)
    });
}

/// Centre of the axis-aligned bounding box.
fn bounding_box_centre(points: &[(Point3<f64>, Rgba)]) -> [f32; 3] {
    [0, 1, 2].map(|axis| {
        let places = points.iter().map(|(place, _)| place[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        f64::midpoint(low, high) as f32
    })
}

/// Quantised point; `None` outside the 16-bit range.
fn quantized_point(
    place: &Point3<f64>,
    color: Rgba,
    origin: &[f32; 3],
) -> Option<[u8; POINT_BYTES]> {
    let steps = |axis: usize| {
        let steps = ((place[axis] - f64::from(origin[axis])) / RESOLUTION_M).round();
        let is_within = (f64::from(i16::MIN)..=f64::from(i16::MAX)).contains(&steps);
        is_within.then(|| (steps as i16).to_le_bytes())
    };
    let ([x0, x1], [y0, y1], [z0, z1]) = (steps(0)?, steps(1)?, steps(2)?);
    let [red, green, blue] = color.rgb();
    Some([x0, x1, y0, y1, z0, z1, red, green, blue])
}

/// Packed cloud with validated bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackedCloud<'a> {
    origin_m: [f32; 3],
    points: &'a [[u8; POINT_BYTES]],
}

impl<'a> PackedCloud<'a> {
    /// Validates bytes from an untrusted source, without a copy.
    ///
    /// # Errors
    /// When they are no packed cloud.
    pub fn checked(bytes: &'a [u8]) -> Result<Self, InvalidCloud> {
        let n_bytes = bytes.len();
        let (header, points) = bytes
            .split_first_chunk::<HEADER_BYTES>()
            .ok_or(InvalidCloud::NoHeader { n_bytes })?;
        let [format, n_points, x, y, z]: [[u8; 4]; 5] = bytemuck::cast(*header);
        let format = u32::from_le_bytes(format);
        if format != FORMAT {
            return Err(InvalidCloud::Format { format });
        }
        let n_points = u32::from_le_bytes(n_points);
        let (points, rest) = points.as_chunks::<POINT_BYTES>();
        if points.len() != n_points as usize || !rest.is_empty() {
            return Err(InvalidCloud::Length { n_points, n_bytes });
        }
        if points.len() > MAX_CLOUD_POINTS {
            return Err(InvalidCloud::TooMany { n_points });
        }
        let origin_m = [x, y, z].map(f32::from_le_bytes);
        if !origin_m.iter().all(|value| value.is_finite()) {
            return Err(InvalidCloud::Origin);
        }
        Ok(Self { origin_m, points })
    }

    /// Number of points of the cloud.
    pub fn n_points(&self) -> usize {
        self.points.len()
    }

    /// Points in the frame of the view's box; all are finite and opaque.
    pub fn points(&self) -> impl ExactSizeIterator<Item = Point> + use<'a> {
        let [x, y, z] = self.origin_m.map(f64::from);
        let place = |origin: f64, steps: [u8; 2]| {
            (origin + RESOLUTION_M * f64::from(i16::from_le_bytes(steps))) as f32
        };
        self.points
            .iter()
            .map(move |&[x0, x1, y0, y1, z0, z1, red, green, blue]| Point {
                x: place(x, [x0, x1]),
                y: place(y, [y0, y1]),
                z: place(z, [z0, z1]),
                color: Rgba::opaque(red, green, blue),
            })
    }
}

/// Error of decoding a packed cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidCloud {
    /// Packed cloud with fewer bytes than its header.
    #[error(
        "{n_bytes} bytes are too few for a packed cloud, which begins with {header_bytes}: \
         send all of it",
        header_bytes = HEADER_BYTES
    )]
    NoHeader {
        /// Length of the packed cloud, bytes.
        n_bytes: usize,
    },
    /// Unknown format number of a packed cloud.
    #[error(
        "the packed cloud has format {format}, known is {known}: use the tabula of its \
         version",
        known = FORMAT
    )]
    Format {
        /// Format number found in the packed cloud.
        format: u32,
    },
    /// Length in bytes that contradicts the number of points.
    #[error(
        "a packed cloud of {n_points} points does not have {n_bytes} bytes but \
         {header_bytes} and {point_bytes} for each point: pack it again",
        header_bytes = HEADER_BYTES,
        point_bytes = POINT_BYTES
    )]
    Length {
        /// Number of points in the packed cloud's header.
        n_points: u32,
        /// Length of the packed cloud, bytes.
        n_bytes: usize,
    },
    /// Packed cloud with more than [`MAX_CLOUD_POINTS`] points.
    #[error(
        "the packed cloud has {n_points} points, but {max_points} are the most: pack \
         fewer of them",
        max_points = MAX_CLOUD_POINTS
    )]
    TooMany {
        /// Number of points of the packed cloud.
        n_points: u32,
    },
    /// Packed cloud whose origin is not finite.
    #[error("the origin of the packed cloud is not finite: pack it again")]
    Origin,
}

#[cfg(test)]
mod tests;
