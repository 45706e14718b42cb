//! Raw images of a source, borrowed, and their conversion to the pixels of a message.

use geometry::{PinholeCamera, RigidTransform};
use point_cloud::Point;

/// Depth without a measurement, millimetres.
const NO_DEPTH_MM: u16 = 0;
/// Depth pixel of recordings that stands for no measurement.
const INVALID_UNITS: u16 = u16::MAX;

/// Raw images from which a source has computed a cloud.
#[derive(Debug, Clone, Copy)]
pub struct SourceImages<'a> {
    /// Depth pixels, row by row.
    pub depth: DepthPixels<'a>,
    /// Red, green and blue of each colour pixel, row by row.
    pub color_rgb: &'a [u8],
    /// Intrinsics and size of the depth image, in whose frame the cloud is.
    pub depth_camera: PinholeCamera,
    /// Intrinsics and size of the colour image.
    pub color_camera: PinholeCamera,
    /// Transform from the depth camera's frame to the colour camera's; `None` for registered
    /// images, a pixel of both of which shows the same point.
    pub color_from_depth: Option<RigidTransform>,
}

/// Depth pixels in the encoding of their source.
#[derive(Debug, Clone, Copy)]
pub enum DepthPixels<'a> {
    /// Multiples of a unit; 0 and 65535 without depth.
    Units {
        /// Values of the pixels.
        pixels: &'a [u16],
        /// Length of the unit, millimetres.
        unit_mm: f64,
    },
    /// Sensor values with a look-up table; values beyond the table have no depth.
    Table {
        /// Values of the pixels.
        pixels: &'a [u16],
        /// Millimetres of each value; 0 without depth.
        mm_of_value: &'a [u16],
    },
}

impl DepthPixels<'_> {
    /// Number of depth pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Units { pixels, .. } | Self::Table { pixels, .. } => pixels.len(),
        }
    }

    /// True without any pixel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the pixels as millimetres, 16 bits, little-endian; `out` has two bytes for each.
    pub(crate) fn write_mm(&self, out: &mut [u8]) {
        let out = out.as_chunks_mut::<2>().0.iter_mut();
        match *self {
            Self::Units {
                pixels,
                unit_mm: 1.0,
            } => {
                for (bytes, &value) in out.zip(pixels) {
                    *bytes = without_invalid(value).to_le_bytes();
                }
            }
            Self::Units { pixels, unit_mm } => {
                for (bytes, &value) in out.zip(pixels) {
                    let depth_mm = f64::from(without_invalid(value)) * unit_mm;
                    *bytes = rounded_mm(depth_mm).to_le_bytes();
                }
            }
            Self::Table {
                pixels,
                mm_of_value,
            } => {
                for (bytes, &value) in out.zip(pixels) {
                    let depth_mm = mm_of_value.get(usize::from(value));
                    *bytes = depth_mm.copied().unwrap_or(NO_DEPTH_MM).to_le_bytes();
                }
            }
        }
    }
}

fn without_invalid(value: u16) -> u16 {
    if value == INVALID_UNITS {
        NO_DEPTH_MM
    } else {
        value
    }
}

/// Rounds a depth to whole millimetres; 0 for NaN and for depths that do not fit.
pub fn rounded_mm(depth_mm: f64) -> u16 {
    let rounded = depth_mm.round();
    if (1.0..f64::from(INVALID_UNITS)).contains(&rounded) {
        rounded as u16
    } else {
        NO_DEPTH_MM
    }
}

/// Writes the depth of organised points as millimetres, 16 bits, little-endian.
pub(crate) fn write_depth_of_points(points: &[Point], out: &mut [u8]) {
    for (bytes, point) in out.as_chunks_mut::<2>().0.iter_mut().zip(points) {
        *bytes = rounded_mm(f64::from(point.z) * 1000.0).to_le_bytes();
    }
}

/// Writes the colours of organised points as red, green and blue.
pub(crate) fn write_color_of_points(points: &[Point], out: &mut [u8]) {
    for (bytes, point) in out.as_chunks_mut::<3>().0.iter_mut().zip(points) {
        *bytes = point.color.rgb();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    fn written(pixels: DepthPixels<'_>) -> Vec<u16> {
        let mut bytes = vec![0xaa; 2 * pixels.len()];
        pixels.write_mm(&mut bytes);
        let pixels = bytes.as_chunks::<2>().0.iter();
        pixels.map(|&pair| u16::from_le_bytes(pair)).collect()
    }

    #[test]
    fn depth_of_every_encoding_becomes_millimetres() {
        let pixels = &[0, 1, 1003, 65_534, 65_535];
        let units = |unit_mm| written(DepthPixels::Units { pixels, unit_mm });
        assert_eq!(units(1.0), [0, 1, 1003, 65_534, 0]);
        assert_eq!(units(0.1), [0, 0, 100, 6553, 0]);
        assert_eq!(units(2.0), [0, 2, 2006, 0, 0]);
        let mm_of_value = &[0, 407];
        let table = DepthPixels::Table {
            pixels,
            mm_of_value,
        };
        assert_eq!(written(table), [0, 407, 0, 0, 0]);
    }

    #[test]
    fn depth_of_points_is_rounded_and_absent_when_it_does_not_fit() {
        let at = |z| Point {
            z,
            ..Point::without_depth(Rgba::opaque(1, 2, 3))
        };
        let depths_m = [0.8004, 0.8006, f32::NAN, -1.0, 0.0, 66.0, f32::INFINITY];
        let points = depths_m.map(at);
        let mut bytes = [0; 14];
        write_depth_of_points(&points, &mut bytes);
        let depths = bytes.as_chunks::<2>().0.iter();
        let depths: Vec<u16> = depths.map(|&pair| u16::from_le_bytes(pair)).collect();
        assert_eq!(depths, [800, 801, 0, 0, 0, 0, 0]);
        let mut color = [0; 21];
        write_color_of_points(&points, &mut color);
        assert_eq!(color[18..], [1, 2, 3]);
    }
}
