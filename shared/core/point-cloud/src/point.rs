//! Coloured 3D point.

use bytemuck::{Pod, Zeroable};
use nalgebra::Point3;

/// Packed colour, 8 bits per channel: alpha, red, green, blue from the highest byte to the
/// lowest, as in PCL.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(transparent)]
pub struct Rgba(pub u32);

impl Rgba {
    /// Creates an opaque colour.
    #[inline]
    pub const fn opaque(red: u8, green: u8, blue: u8) -> Self {
        Self(0xff00_0000 | (red as u32) << 16 | (green as u32) << 8 | blue as u32)
    }

    /// Red, green and blue channels of the colour.
    #[inline]
    pub const fn rgb(self) -> [u8; 3] {
        [(self.0 >> 16) as u8, (self.0 >> 8) as u8, self.0 as u8]
    }
}

/// Coloured point, 16 bytes: coordinates in metres and a packed colour.
///
/// Frame: the camera's (x right, y down, z forward) unless a name says
/// otherwise. A point without depth has NaN coordinates; its colour may still
/// be valid.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Point {
    /// Right coordinate in the camera frame, metres.
    pub x: f32,
    /// Down coordinate in the camera frame, metres.
    pub y: f32,
    /// Forward coordinate in the camera frame, metres.
    pub z: f32,
    /// Colour of the point.
    pub color: Rgba,
}

impl Point {
    /// Creates the point of a pixel without depth: three NaN coordinates.
    pub const fn without_depth(color: Rgba) -> Self {
        Self {
            x: f32::NAN,
            y: f32::NAN,
            z: f32::NAN,
            color,
        }
    }

    /// True if all three coordinates are finite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// Position of the point in double precision, metres.
    #[inline]
    pub fn position(&self) -> Point3<f64> {
        Point3::new(f64::from(self.x), f64::from(self.y), f64::from(self.z))
    }
}
