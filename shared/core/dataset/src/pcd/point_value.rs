//! Conversion of stored values to points and colours.

use super::layout::ColorField;
use point_cloud::{Point, Rgba};

/// Bits of a fully opaque alpha channel.
pub(super) const OPAQUE: u32 = 0xff00_0000;

/// Colour from its stored bits; opaque when the field has no alpha channel.
#[inline]
pub(super) fn unpack_color(color: ColorField, bits: u32) -> Rgba {
    Rgba(if color.has_alpha { bits } else { bits | OPAQUE })
}

/// Point with finite coordinates, or with three NaN coordinates when one is not finite.
#[inline]
pub(super) fn finite_or_nan(x: f32, y: f32, z: f32, color: Rgba) -> Point {
    let point = Point { x, y, z, color };
    if point.is_finite() {
        point
    } else {
        Point::without_depth(color)
    }
}
