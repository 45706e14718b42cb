//! The cloud of a key view as bytes.
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
use std::fmt;

/// Most points of a packed cloud: with them a view fits into one request.
pub const MAX_CLOUD_POINTS: usize = 30_000;

const FORMAT: u32 = 1;
const HEADER_BYTES: usize = 20;
const POINT_BYTES: usize = 9;
/// Metres between neighbouring places.
const STEP_M: f64 = 1e-4;

/// Packs points, which `frame_from_points` takes to the frame of the view's box; no
/// bytes when no point is left.
///
/// A place is kept to 0.05 mm, beside the rounding of the origin. Of more than
/// [`MAX_CLOUD_POINTS`] as many are kept, evenly among them. Points without depth are
/// left out, and those more than 3.27 m from the middle along an axis.
pub fn pack_cloud<'a>(
    points: impl Iterator<Item = &'a Point>,
    frame_from_points: &RigidTransform,
) -> Vec<u8> {
    let mut placed: Vec<(Point3<f64>, Rgba)> = points
        .filter(|point| point.is_finite())
        .map(|point| (frame_from_points * point.position(), point.color))
        .collect();
    keep_evenly(&mut placed);
    let origin = middle(&placed);
    let mut bytes = Vec::with_capacity(HEADER_BYTES + placed.len() * POINT_BYTES);
    bytes.resize(HEADER_BYTES, 0);
    bytes.extend(
        placed
            .iter()
            .filter_map(|(place, color)| packed_point(place, *color, &origin))
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

/// Keeps [`MAX_CLOUD_POINTS`] at most.
fn keep_evenly<T>(points: &mut Vec<T>) {
    let n_points = points.len();
    let share = |n: usize| n * MAX_CLOUD_POINTS / n_points;
    let mut index = 0;
    points.retain(|_| {
        index += 1;
        n_points <= MAX_CLOUD_POINTS || share(index) > share(index - 1)
    });
}

/// The middle of the points' extent along each axis.
fn middle(points: &[(Point3<f64>, Rgba)]) -> [f32; 3] {
    [0, 1, 2].map(|axis| {
        let places = points.iter().map(|(place, _)| place[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        f64::midpoint(low, high) as f32
    })
}

/// `None` out of reach.
fn packed_point(place: &Point3<f64>, color: Rgba, origin: &[f32; 3]) -> Option<[u8; POINT_BYTES]> {
    let steps = |axis: usize| {
        let steps = ((place[axis] - f64::from(origin[axis])) / STEP_M).round();
        let is_within = (f64::from(i16::MIN)..=f64::from(i16::MAX)).contains(&steps);
        is_within.then(|| (steps as i16).to_le_bytes())
    };
    let ([x0, x1], [y0, y1], [z0, z1]) = (steps(0)?, steps(1)?, steps(2)?);
    let [red, green, blue] = color.rgb();
    Some([x0, x1, y0, y1, z0, z1, red, green, blue])
}

/// A packed cloud whose bytes were checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackedCloud<'a> {
    origin_m: [f32; 3],
    points: &'a [[u8; POINT_BYTES]],
}

impl<'a> PackedCloud<'a> {
    /// Reads bytes from anywhere. Nothing is copied.
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

    /// How many points there are.
    pub fn n_points(&self) -> usize {
        self.points.len()
    }

    /// The points, in the frame of the view's box; all are finite and opaque.
    pub fn points(&self) -> impl ExactSizeIterator<Item = Point> + use<'a> {
        let [x, y, z] = self.origin_m.map(f64::from);
        let place = |origin: f64, steps: [u8; 2]| {
            (origin + STEP_M * f64::from(i16::from_le_bytes(steps))) as f32
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

/// Why bytes are no packed cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum InvalidCloud {
    /// They are too few for a header.
    NoHeader {
        /// How many there are.
        n_bytes: usize,
    },
    /// They are of a format that is not known.
    Format {
        /// Its number.
        format: u32,
    },
    /// They are more or fewer than the points need.
    Length {
        /// Points by the header.
        n_points: u32,
        /// How many bytes there are.
        n_bytes: usize,
    },
    /// There are more than [`MAX_CLOUD_POINTS`].
    TooMany {
        /// How many there are.
        n_points: u32,
    },
    /// The origin is not finite.
    Origin,
}

impl fmt::Display for InvalidCloud {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoHeader { n_bytes } => write!(
                f,
                "{n_bytes} bytes are too few for a packed cloud, which begins with {HEADER_BYTES}: \
                 send all of it"
            ),
            Self::Format { format } => write!(
                f,
                "the packed cloud has format {format}, known is {FORMAT}: use the tabula of its \
                 version"
            ),
            Self::Length { n_points, n_bytes } => write!(
                f,
                "a packed cloud of {n_points} points does not have {n_bytes} bytes but \
                 {HEADER_BYTES} and {POINT_BYTES} for each point: pack it again"
            ),
            Self::TooMany { n_points } => write!(
                f,
                "the packed cloud has {n_points} points, but {MAX_CLOUD_POINTS} are the most: pack \
                 fewer of them"
            ),
            Self::Origin => write!(
                f,
                "the origin of the packed cloud is not finite: pack it again"
            ),
        }
    }
}

impl std::error::Error for InvalidCloud {}

#[cfg(test)]
mod tests;
